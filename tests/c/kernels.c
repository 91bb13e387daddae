/* The C interface: known results, and every kernel in many threads at once, bit for bit as in one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#include "bezel.h"

enum { most_nodes = 64, row_size = 60000, samples = 600 };

static int failures;

static void expect(int condition, const char *what) {
  if (condition) return;
  printf("failed: %s\n", what);
  failures++;
}

static double next(unsigned *state) { /* in (-1,1) */
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 8388608.0 - 1;
}

typedef struct {
  double *data;
  int length;
} row;

static void put(row *r, const double *values, int n) {
  if (r->length + n > row_size) abort();
  memcpy(r->data + r->length, values, n * sizeof *values);
  r->length += n;
}

static void put_int(row *r, int value) {
  double v = value;
  put(r, &v, 1);
}

/* A Bezier element of degree p: the operator is the identity plus noise, control points lie on a disturbed grid. */
static int element(unsigned *state, int dp, int ndm, int p, double *we, double *ce, double *xe) {
  int n = 1, a, i, k;
  for (i = 0; i < dp; i++) n *= p + 1;
  for (k = 0; k < n * n; k++) ce[k] = 0.02 * next(state);
  for (a = 0; a < n; a++) {
    int at = a;
    ce[a + n * a] += 1;
    we[a] = 1 + 0.2 * next(state);
    for (i = 0; i < ndm; i++) {
      xe[i + ndm * a] = 0.1 * next(state) / p;
      if (i < dp) xe[i + ndm * a] += (double)(at % (p + 1)) / p;
      at /= p + 1;
    }
  }
  return n;
}

static void solid(int i, row *r) {
  unsigned state = 77u * i + 5;
  int ndm = 2 + i % 2, p = 1 + (i / 2) % 3, degree[3] = {p, p, p}, rule[3] = {p + 1, p + 1, p + 1}, n, ng, a, g, k, status;
  int kinds[4] = {bezel_neo_hooke, bezel_neo_hooke_quadratic, bezel_st_venant, bezel_small_strain};
  double we[64], ce[64 * 64], xe[3 * 64], xi[3 * 64], wt[64], shp[64 * 64], dshp[3 * 64 * 64], dvol[64], ue[3 * 64];
  double fe[3 * 64], energy, sigma[6 * 64], load[3 * 64];
  double *ke = malloc(sizeof(double) * 192 * 192);
  bezel_solid_law law;

  n = element(&state, ndm, ndm, p, we, ce, xe);
  bezel_tensor_rule(ndm, rule, xi, wt);
  for (ng = 1, k = 0; k < ndm; k++) ng *= p + 1;
  put_int(r, bezel_solid_points(ndm, degree, n, xe, we, ce, ng, xi, wt, shp, dshp, dvol));
  put(r, shp, n * ng);
  put(r, dvol, ng);
  put_int(r, bezel_define_solid_law(kinds[(i / 6) % 4], ndm == 3 ? bezel_three_dimensional : 1 + (i / 24) % 2, 10, 0.3, &law));
  for (a = 0; a < ndm * n; a++) ue[a] = 0.02 * next(&state) / p;
  status = bezel_solid_tangent(ndm, n, ng, dshp, dvol, ue, &law, fe, ke, &energy);
  bezel_mirror(ndm, n, ke);
  put_int(r, status);
  put(r, fe, ndm * n);
  put(r, ke, ndm * n * ndm * n);
  put(r, &energy, 1);
  put_int(r, bezel_solid_force(ndm, n, ng, dshp, dvol, ue, &law, fe, &energy));
  put(r, fe, ndm * n);
  put_int(r, bezel_solid_cauchy(ndm, n, ng, dshp, ue, &law, sigma));
  put(r, sigma, 6 * ng);
  for (g = 0; g < ndm * ng; g++) load[g] = next(&state);
  bezel_body_force(ndm, n, ng, shp, dvol, load, fe);
  put(r, fe, ndm * n);
  free(ke);
}

/* A facet with its functions, the loads on it, and a point below it. */
static void surface(int i, row *r) {
  unsigned state = 991u * i + 13;
  int ndm = 2 + i % 2, dp = ndm - 1, p = 1 + (i / 2) % 3, degree[2] = {p, p}, rule[2] = {p + 1, p + 1}, n, ng, a, g, k;
  int held[2] = {1, 0};
  double we[16], ce[16 * 16], xe[3 * 16], ue[3 * 16], xi[2 * 16], wt[16], shp[16 * 16], dshp[2 * 16 * 16], d2shp[3 * 16];
  double fe[3 * 32], ke[96 * 96], load[3 * 16], pressure[16], x[3], tau[6], nrm[3], area, xs[3 * 16], guess[2] = {0.4, 0.4};
  double metric[4], inverse[4], curvature[4];
  bezel_projection report;
  bezel_gap_law law;
  bezel_gap_response response;

  n = element(&state, dp, ndm, p, we, ce, xe);
  bezel_tensor_rule(dp, rule, xi, wt);
  for (ng = 1, k = 0; k < dp; k++) ng *= p + 1;
  for (g = 0; g < ng; g++) {
    put_int(r, bezel_shape_functions(dp, degree, n, we, ce, xi + dp * g, 1, shp + n * g, dshp + dp * n * g, NULL));
    pressure[g] = 1 + 0.3 * next(&state);
    for (k = 0; k < ndm; k++) load[k + ndm * g] = next(&state);
  }
  for (a = 0; a < ndm * n; a++) ue[a] = 0.03 * next(&state);
  bezel_dead_traction(ndm, n, ng, xe, shp, dshp, wt, load, fe);
  put(r, fe, ndm * n);
  bezel_dead_pressure(ndm, n, ng, xe, shp, dshp, wt, pressure, fe);
  put(r, fe, ndm * n);
  bezel_follower_pressure(ndm, n, ng, xe, ue, shp, dshp, wt, pressure, fe, ke);
  put(r, fe, ndm * n);
  put(r, ke, ndm * n * ndm * n);

  put_int(r, bezel_shape_functions(dp, degree, n, we, ce, guess, 2, shp, dshp, d2shp));
  put_int(r, bezel_surface_frame(ndm, n, xe, shp, dshp, d2shp, x, tau, nrm, metric, inverse, curvature, &area));
  put(r, curvature, dp * dp);
  put_int(r, bezel_tangent_frame(ndm, n, xe, shp, dshp, x, tau, nrm, &area));
  for (a = 0; a < n; a++)
    for (k = 0; k < ndm; k++) xs[k + ndm * a] = x[k] - 0.01 * nrm[k];
  put_int(r, bezel_closest_point(ndm, degree, n, we, ce, xe, xs, 1, guess, &report));
  put_int(r, bezel_closest_point(ndm, degree, n, we, ce, xe, xs, 0, guess, &report));
  put(r, guess, dp);
  put(r, &report.distance, 1);
  put_int(r, bezel_contact_law(1e3, &law));
  put_int(r, bezel_cohesive_law_of_stiffness(1e3, 1, 0.5, 100, &law));
  bezel_interface_response(&law, 0.02 * (i % 40), 0.1, &response);
  put(r, &response.gap, 8);
  put_int(r, bezel_cohesive_law(1e3, 1, 0.5, 0.01, &law));
  put_int(r, bezel_gpts_point(ndm, n, shp, xs, n, shp, dshp, d2shp, xe, i % 3 ? 1 : -1, &law, 0.001, 0.5, 1, &response, fe, ke));
  put(r, fe, 2 * ndm * n);
  bezel_mirror(ndm, 2 * n, ke);
  put(r, ke, 4 * ndm * n * ndm * n);
  put(r, &response.gap, 8);
  put_int(r, bezel_gpts_corner_point(ndm, n, shp, xs, n, shp, dshp, d2shp, xe, 1, held, &law, 0.001, 0.5, 1, &response, fe, ke));
  bezel_mirror(ndm, 2 * n, ke);
  put(r, ke, 4 * ndm * n * ndm * n);
}

static void shell(int i, row *r) {
  unsigned state = 313u * i + 7;
  int p = 2 + i % 2, degree[2] = {p, p}, rule[2] = {p + 1, p + 1}, n, ng = (p + 1) * (p + 1), a, g, k;
  double we[16], ce[16 * 16], xe[3 * 16], ue[3 * 16], xi[2 * 16], wt[16], shp[16 * 16], dshp[5 * 16 * 16], frame[15 * 16];
  double area[16], fe[3 * 16], ke[48 * 48], energy, d1[2 * 16 * 16], along[3 * 16 * 16], start[9 * 16], one[16], zero[16];
  bezel_shell_law law;

  n = element(&state, 2, 3, p, we, ce, xe);
  bezel_tensor_rule(2, rule, xi, wt);
  put_int(r, bezel_shell_points(degree, n, xe, we, ce, ng, xi, wt, shp, dshp, frame, area));
  put(r, area, ng);
  put(r, dshp, 5 * n * ng);
  put_int(r, bezel_define_shell_law(100, 0.3, 0.1, i % 3 == 0, &law));
  for (a = 0; a < 3 * n; a++) ue[a] = 0.02 * next(&state);
  put_int(r, bezel_shell_tangent(n, ng, dshp, frame, area, ue, &law, fe, ke, &energy));
  bezel_mirror(3, n, ke);
  put(r, fe, 3 * n);
  put(r, ke, 9 * n * n);
  put_int(r, bezel_shell_force(n, ng, dshp, frame, area, ue, &law, fe, &energy));
  put(r, fe, 3 * n);
  put(r, &energy, 1);
  for (g = 0; g < ng; g++) {
    put_int(r, bezel_shape_functions(2, degree, n, we, ce, xi + 2 * g, 1, shp, d1 + 2 * n * g, NULL));
    one[g] = 1;
    zero[g] = 0;
    for (k = 0; k < 9; k++) start[k + 9 * g] = next(&state);
    for (a = 0; a < 3 * n; a++) along[a + 3 * n * g] = next(&state);
  }
  put_int(r, bezel_edge_moment(1 + i % 4, n, ng, xe, ue, d1, wt, 2.5, fe, ke));
  put(r, fe, 3 * n);
  put(r, ke, 9 * n * n);
  put_int(r, bezel_joint_force(n, ng, along, start, wt, one, zero, 3, i % 2, ue, fe, ke, &energy));
  bezel_mirror(3, n, ke);
  put(r, fe, 3 * n);
  put(r, ke, 9 * n * n);
}

static void run(int i, row *r) {
  r->length = 0;
  if (i % 3 == 0) solid(i / 3, r);
  if (i % 3 == 1) surface(i / 3, r);
  if (i % 3 == 2) shell(i / 3, r);
}

static void many_threads(int threads) {
  row *serial = malloc(samples * sizeof *serial);
  int different = 0, bad = 0, i;
  for (i = 0; i < samples; i++) {
    row r = {malloc(row_size * sizeof(double)), 0};
    int k;
    run(i, &r);
    serial[i].data = malloc(r.length * sizeof(double));
    serial[i].length = r.length;
    memcpy(serial[i].data, r.data, r.length * sizeof(double));
    for (k = 0; k < r.length; k++) bad += !isfinite(r.data[k]);
    free(r.data);
  }
  expect(bad == 0, "all results are numbers");
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1) reduction(+ : different)
  for (i = 0; i < 4 * samples; i++) {
    row r = {malloc(row_size * sizeof(double)), 0};
    int s = (i * 7) % samples;
    run(s, &r);
    different += r.length != serial[s].length || memcmp(r.data, serial[s].data, r.length * sizeof(double)) != 0;
    free(r.data);
  }
  printf("%d calls in %d threads, %d results differ from the serial ones\n", 4 * samples, threads, different);
  expect(different == 0, "threads and serial agree bit for bit");
  for (i = 0; i < samples; i++) free(serial[i].data);
  free(serial);
}

/* The bilinear unit square in plane stress: first row of the stiffness times (1 - nu^2)/E, counter-clockwise from (0,0). */
static void known_stiffness(void) {
  double nu = 0.3, k[8] = {1 / 2. - nu / 6, 1 / 8. + nu / 8, -1 / 4. - nu / 12, -1 / 8. + 3 * nu / 8,
                           -1 / 4. + nu / 12, -1 / 8. - nu / 8, nu / 6, 1 / 8. - 3 * nu / 8};
  int order[4] = {0, 1, 3, 2}, degree[2] = {1, 1}, rule[2] = {2, 2}, a, i;
  double we[4] = {1, 1, 1, 1}, ce[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, xe[8] = {0, 0, 1, 0, 0, 1, 1, 1};
  double xi[8], wt[4], shp[16], dshp[32], dvol[4], ue[8] = {0}, fe[8], ke[64], energy, worst = 0;
  bezel_solid_law law;

  expect(bezel_define_solid_law(bezel_small_strain, bezel_plane_stress, 1, nu, &law) == 0, "the law is accepted");
  bezel_tensor_rule(2, rule, xi, wt);
  expect(bezel_solid_points(2, degree, 4, xe, we, ce, 4, xi, wt, shp, dshp, dvol) == 0, "the square is accepted");
  expect(bezel_solid_tangent(2, 4, 4, dshp, dvol, ue, &law, fe, ke, &energy) == 0, "the square has a stiffness");
  bezel_mirror(2, 4, ke);
  for (a = 0; a < 4; a++)
    for (i = 0; i < 2; i++) worst = fmax(worst, fabs(ke[2 * order[a] + i] * (1 - nu * nu) - k[2 * a + i]));
  printf("stiffness of the unit square: largest error %.1e\n", worst);
  expect(worst < 1e-15, "the stiffness is the one of textbooks");
}

static void failures_are_told(void) {
  int degree[2] = {1, 1}, rule[2] = {2, 2};
  double we[4] = {1, 1, 1, 1}, ce[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, xe[8] = {1, 0, 0, 0, 1, 1, 0, 1};
  double xi[8], wt[4], shp[16], dshp[32], dvol[4];
  char text[80], little[6];
  bezel_solid_law law;

  bezel_tensor_rule(2, rule, xi, wt);
  expect(bezel_solid_points(2, degree, 4, xe, we, ce, 4, xi, wt, shp, dshp, dvol) == bezel_inverted_element,
         "an inverted element is refused");
  expect(bezel_define_solid_law(bezel_neo_hooke, bezel_plane_strain, -1, 0.3, &law) == bezel_bad_law_data,
         "a negative modulus is refused");
  bezel_status_text(bezel_inverted_element, text, sizeof text);
  expect(strstr(text, "inverted") != NULL, "the status has a text");
  bezel_status_text(bezel_inverted_element, little, sizeof little);
  expect(strlen(little) == 5, "a short text is cut");
}

/* A point 0.11 above a straight line from (0,0) to (-1,0), whose normal points up: the gap is that of faces 0.125 apart. */
static void offset_shifts_the_gap(void) {
  double shp_s[1] = {1}, xs[2] = {-0.5, 0.11}, shp_m[2] = {0.5, 0.5}, dshp_m[2] = {-1, 1}, d2shp_m[2] = {0, 0};
  double xm[4] = {0, 0, -1, 0}, fe[6], ke[36];
  bezel_gap_law law;
  bezel_gap_response plain, shifted;

  expect(bezel_contact_law(1e3, &law) == 0 && law.offset == 0, "a law has no offset of itself");
  expect(bezel_gpts_point(2, 1, shp_s, xs, 2, shp_m, dshp_m, d2shp_m, xm, 1, &law, 0, 1, 1, &plain, fe, ke) == 0,
         "a point above");
  law.offset = 0.125;
  expect(bezel_gpts_point(2, 1, shp_s, xs, 2, shp_m, dshp_m, d2shp_m, xm, 1, &law, 0, 1, 1, &shifted, fe, ke) == 0,
         "a point between");
  expect(fabs(plain.gap - 0.11) < 1e-15 && plain.traction == 0, "without offset the point is free");
  expect(fabs(shifted.gap + 0.015) < 1e-15 && fabs(shifted.traction + 15) < 1e-11 && fabs(fe[1] + 15) < 1e-11,
         "the offset shifts the gap");
}

static void sides_are_directed(void) {
  int degree[2] = {2, 1}, side_degree[1], rows[6], n, k;
  double ce[36] = {0}, ce_side[36];
  for (k = 0; k < 6; k++) ce[7 * k] = 1;
  expect(bezel_side_functions(2, degree, 4) == 3, "the top has three Bernstein polynomials");
  n = bezel_side_operator(2, degree, 6, ce, 4, side_degree, rows, ce_side);
  expect(n == 3 && side_degree[0] == 2 && rows[0] == 3 && rows[2] == 5, "the top has the last three functions");
  expect(ce_side[2] == 1 && ce_side[4] == 1 && ce_side[6] == 1 && ce_side[0] == 0, "the top runs s down");
}

int main(int argc, char **argv) {
  known_stiffness();
  failures_are_told();
  sides_are_directed();
  offset_shifts_the_gap();
  many_threads(argc > 1 ? atoi(argv[1]) : 32);
  printf("%d failures\n", failures);
  return failures != 0;
}
