/* CHOLMOD behind opaque handles: its structs differ between major versions, so that only C, which includes its
 * headers, may look into them. Matrices are the lower triangle in compressed columns, counted from 0, rows ascending,
 * the diagonal entry first in its column. Nothing is printed and nothing global is kept. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <cholmod.h>

enum { SHIM_OK = 0, SHIM_NOT_POSDEF = 1, SHIM_OUT_OF_MEMORY = 2, SHIM_FAILED = 3 };
enum { ORDER_AMD = 1, ORDER_METIS = 2 };

typedef struct {
  cholmod_common common;
  cholmod_factor *factor;
  cholmod_sparse *permuted; /* the matrix in the order of elimination, for a supernodal factor */
  int *source;              /* where each of its values comes from */
  cholmod_dense *x, *y, *e; /* solution and work space, kept from solve to solve */
} shim;

/* The supernodal factorisation of CHOLMOD 3 (SuiteSparse 5) opens parallel regions of four threads whatever the
 * environment says. At our sizes they only cost time, a factor of three to five, and the threads would not be ours. No
 * active level of parallelism makes each region serial. The run-time library is asked for by name because CHOLMOD may
 * use any or none. Returns the number of levels before, to restore; negative: there is nothing to restore. */
static int parallel_levels(int levels) {
  int (*get)(void), before;
  void (*set)(int);
  if (levels < 0) return levels;
  *(void **)&get = dlsym(RTLD_DEFAULT, "omp_get_max_active_levels");
  *(void **)&set = dlsym(RTLD_DEFAULT, "omp_set_max_active_levels");
  if (!get || !set) return -1;
  before = get();
  set(levels);
  return before;
}

static int shim_status(const shim *s) {
  switch (s->common.status) {
    case CHOLMOD_OK: case CHOLMOD_DSMALL: return SHIM_OK;
    case CHOLMOD_NOT_POSDEF: return SHIM_NOT_POSDEF;
    case CHOLMOD_OUT_OF_MEMORY: case CHOLMOD_TOO_LARGE: return SHIM_OUT_OF_MEMORY;
    default: return SHIM_FAILED;
  }
}

static cholmod_sparse lower_matrix(int n, const int *ptr, const int *ind, const double *val) {
  cholmod_sparse a = {0};
  a.nrow = (size_t)n;
  a.ncol = (size_t)n;
  a.nzmax = (size_t)ptr[n];
  a.p = (void *)ptr;
  a.i = (void *)ind;
  a.x = (void *)val;
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = val ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 1;
  return a;
}

static void free_analysis(shim *s) {
  cholmod_free_factor(&s->factor, &s->common);
  cholmod_free_sparse(&s->permuted, &s->common);
  free(s->source);
  s->source = NULL;
}

void *bezel_cholmod_open(void) {
  shim *s = calloc(1, sizeof *s);
  if (!s) return NULL;
  if (!cholmod_start(&s->common)) { free(s); return NULL; }
  s->common.print = 0;
  s->common.error_handler = NULL;
#if CHOLMOD_MAIN_VERSION < 4
  s->common.useGPU = 0;
#else
  s->common.nthreads_max = 1;
#endif
  s->common.final_ll = 1;
  s->common.quick_return_if_not_posdef = 1;
  s->common.nmethods = 1;
  s->common.method[0].ordering = CHOLMOD_GIVEN;
  return s;
}

void bezel_cholmod_close(void *handle) {
  shim *s = handle;
  if (!s) return;
  free_analysis(s);
  cholmod_free_dense(&s->x, &s->common);
  cholmod_free_dense(&s->y, &s->common);
  cholmod_free_dense(&s->e, &s->common);
  cholmod_finish(&s->common);
  free(s);
}

/* Fill-reducing order of a graph given by its lower triangle: perm[k] is the k-th vertex to eliminate. flops: what the
 * factorisation of one equation per vertex costs in this order. */
int bezel_cholmod_order(void *handle, int n, const int *ptr, const int *ind, int method, int *perm, double *flops) {
  shim *s = handle;
  cholmod_sparse a = lower_matrix(n, ptr, ind, NULL);
  *flops = 0;
  if (method == ORDER_AMD) {
    if (!cholmod_amd(&a, NULL, 0, perm, &s->common)) return shim_status(s);
  } else {
    if (!cholmod_metis(&a, NULL, 0, 0, perm, &s->common)) return shim_status(s);
    s->common.supernodal = CHOLMOD_SIMPLICIAL;
    cholmod_factor *counted = cholmod_analyze_p(&a, perm, NULL, 0, &s->common);
    if (!counted) return shim_status(s);
    cholmod_free_factor(&counted, &s->common);
  }
  *flops = s->common.fl;
  return SHIM_OK;
}

/* Permute the pattern once; a factorisation then only gathers the values. CHOLMOD would permute both each time. Rows
 * are not sorted: the supernodal factorisation does not ask for it. */
static int permute_pattern(shim *s, int n, const int *ptr, const int *ind) {
  size_t nnz = (size_t)ptr[n];
  const int *perm = s->factor->Perm;
  int *inverse = malloc(sizeof(int) * ((size_t)n + 1)), *next = calloc((size_t)n + 1, sizeof(int));
  s->source = malloc(sizeof(int) * (nnz + 1));
  s->permuted = cholmod_allocate_sparse((size_t)n, (size_t)n, nnz, 0, 1, -1, CHOLMOD_REAL, &s->common);
  int status = inverse && next && s->source && s->permuted ? SHIM_OK : SHIM_OUT_OF_MEMORY;
  if (status == SHIM_OK) {
    int *sp = s->permuted->p, *si = s->permuted->i;
    for (int k = 0; k < n; k++) inverse[perm[k]] = k;
    for (int j = 0; j < n; j++) {
      for (int k = ptr[j]; k < ptr[j + 1]; k++) {
        int r = inverse[ind[k]], c = inverse[j];
        next[r < c ? r : c]++;
      }
    }
    sp[0] = 0;
    for (int j = 0; j < n; j++) {
      sp[j + 1] = sp[j] + next[j];
      next[j] = sp[j];
    }
    for (int j = 0; j < n; j++) {
      for (int k = ptr[j]; k < ptr[j + 1]; k++) {
        int r = inverse[ind[k]], c = inverse[j], to = next[r < c ? r : c]++;
        si[to] = r < c ? c : r;
        s->source[to] = k;
      }
    }
  }
  free(inverse);
  free(next);
  return status;
}

/* info: entries of the factor, floating-point operations, 1 where supernodal */
int bezel_cholmod_analyse(void *handle, int n, const int *ptr, const int *ind, const int *perm, int variant,
                          double info[3]) {
  shim *s = handle;
  cholmod_sparse a = lower_matrix(n, ptr, ind, NULL);
  free_analysis(s);
  s->common.supernodal = variant == 1 ? CHOLMOD_SIMPLICIAL : variant == 2 ? CHOLMOD_SUPERNODAL : CHOLMOD_AUTO;
  s->factor = cholmod_analyze_p(&a, (int *)perm, NULL, 0, &s->common);
  if (!s->factor) return shim_status(s);
  info[0] = s->common.lnz;
  info[1] = s->common.fl;
  info[2] = s->factor->is_super;
  return s->factor->is_super ? permute_pattern(s, n, ptr, ind) : SHIM_OK;
}

/* Square of the k-th diagonal entry of the factor for each k, in the order of elimination. */
static void squared_pivots(const cholmod_factor *f, double *pivot) {
  const double *x = f->x;
  if (f->is_super) {
    const int *super = f->super, *pi = f->pi, *px = f->px;
    for (size_t k = 0; k < f->nsuper; k++) {
      size_t rows = (size_t)(pi[k + 1] - pi[k]);
      for (int j = super[k]; j < super[k + 1]; j++) {
        double d = x[px[k] + (size_t)(j - super[k]) * (rows + 1)];
        pivot[j] = d * d;
      }
    }
  } else {
    const int *p = f->p;
    for (size_t j = 0; j < f->n; j++) pivot[j] = f->is_ll ? x[p[j]] * x[p[j]] : x[p[j]];
  }
}

/* info: estimate of the reciprocal condition; smallest ratio of a pivot to the diagonal entry that it came from, which
 * does not depend on the scaling of the unknowns: near the unit round-off nothing but round-off is left of it. */
int bezel_cholmod_factorise(void *handle, int n, const int *ptr, const int *ind, const double *val, double info[2]) {
  shim *s = handle;
  cholmod_sparse a = lower_matrix(n, ptr, ind, val);
  info[0] = info[1] = 0;
  int levels = parallel_levels(0);
  int done;
  if (s->permuted) {
    double *x = s->permuted->x, beta[2] = {0, 0};
    for (int k = 0; k < ptr[n]; k++) x[k] = val[s->source[k]];
    done = cholmod_super_numeric(s->permuted, NULL, beta, s->factor, &s->common);
  } else {
    done = cholmod_factorize(&a, s->factor, &s->common);
  }
  parallel_levels(levels);
  if (!done) return shim_status(s);
  if (s->common.status == CHOLMOD_NOT_POSDEF || s->factor->minor < s->factor->n) return SHIM_NOT_POSDEF;
  double *pivot = malloc(sizeof(double) * (size_t)(n > 0 ? n : 1));
  if (!pivot) return SHIM_OUT_OF_MEMORY;
  const int *perm = s->factor->Perm;
  double smallest = 1, low = INFINITY, high = 0;
  squared_pivots(s->factor, pivot);
  for (int k = 0; k < n; k++) {
    double ratio = pivot[k] / val[ptr[perm ? perm[k] : k]];
    if (!(ratio >= smallest)) smallest = ratio;
    if (pivot[k] < low) low = pivot[k];
    if (pivot[k] > high) high = pivot[k];
  }
  free(pivot);
  info[0] = n > 0 ? low / high : 1;
  info[1] = smallest;
  return shim_status(s);
}

int bezel_cholmod_solve(void *handle, int n, int nrhs, const double *rhs, double *x) {
  shim *s = handle;
  cholmod_dense b = {0};
  b.nrow = (size_t)n;
  b.ncol = (size_t)nrhs;
  b.d = (size_t)n;
  b.nzmax = (size_t)n * (size_t)nrhs;
  b.x = (void *)rhs;
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_solve2(CHOLMOD_A, s->factor, &b, NULL, &s->x, NULL, &s->y, &s->e, &s->common)) return shim_status(s);
  const double *sx = s->x->x;
  for (size_t k = 0; k < b.nzmax; k++) x[k] = sx[k];
  return SHIM_OK;
}
