/* C interface of Bezel's shape functions and element kernels.
 *
 * Arrays are as in Fortran, first index fastest, which a comment states: xe(ndm,nen) is double xe[ndm*nen] with coordinate i of
 * control point a in xe[i + ndm*a]. Extraction operators are ce(nen,nb): coefficient of function a and Bernstein polynomial k
 * in ce[a + nen*k], nb = (degree[0]+1)*(degree[1]+1)*..., first direction fastest. The parent element is [0,1]^dp. Derivatives
 * dshp(dp,nen); second derivatives are packed 11 | 11, 22, 12 | 11, 22, 33, 12, 23, 13. Lengths, forces and stresses have any
 * consistent units.
 *
 * fe(ndm,nen) is the internal force, ke(ndm,nen,ndm,nen) its derivative. Symmetric tangents are filled for the nodes a >= b
 * only (each block complete); bezel_mirror completes them. Elements with ndm dofs a node.
 *
 * Functions that can fail return a status, 0 if all is well, and then write nothing that may be used. All functions may be
 * called in many threads at once: none keeps a state. Work arrays are on the stack, about as much as the arguments take. */
#ifndef BEZEL_H
#define BEZEL_H

#ifdef __cplusplus
extern "C" {
#endif

enum bezel_status {
  bezel_ok = 0,
  bezel_inverted_element = 1,    /* det J or det F is not positive */
  bezel_singular_map = 2,        /* tangents of a facet are parallel or vanish */
  bezel_outside_facet = 3,       /* the projection lies beyond the facet's bounds */
  bezel_singular_projection = 4, /* the point is at a centre of curvature of the facet */
  bezel_no_convergence = 5,      /* the projection did not converge */
  bezel_bad_weight = 6,          /* the weight function is not positive */
  bezel_bad_law_data = 9,        /* law parameters outside their range */
  bezel_law_failed = 10          /* the plane stress iteration failed */
};

/* What happened, in words; at most length - 1 characters. */
void bezel_status_text(int status, char *text, int length);

/* ---- shape functions ---- */

/* Rational functions of an element at a point: shp(nen); dshp(dp,nen) if nd >= 1; d2shp(dp*(dp+1)/2,nen) if nd >= 2 (else these
 * may be NULL). */
int bezel_shape_functions(int dp, const int *degree, int nen, const double *we, const double *ce, const double *xi, int nd,
                          double *shp, double *dshp, double *d2shp);

/* Gauss-Legendre rule on [0,1]^dp with n[i] points in direction i: xi(dp,ng), wt(ng), ng their product. */
void bezel_tensor_rule(int dp, const int *n, double *xi, double *wt);

/* Side 1: s=0, 2: s=1, 3: t=0, 4: t=1, 5: u=0, 6: u=1 of an element as an element one direction lower, its parameters directed
 * so that the normal points outward. bezel_side_functions: the side's number nb of Bernstein polynomials. bezel_side_operator
 * returns the number n of functions on the side: rows[0..n-1] are their places in the element, from 0; ce_side(n,nb). Room is
 * needed for nen rows. */
int bezel_side_functions(int dp, const int *degree, int side);
int bezel_side_operator(int dp, const int *degree, int nen, const double *ce, int side, int *side_degree, int *rows,
                        double *ce_side);

/* Position x(ndm), tangents tau(ndm,ndm-1), unit normal nrm(ndm) and area element of a facet with control points xm(ndm,nen). */
int bezel_tangent_frame(int ndm, int nen, const double *xm, const double *shp, const double *dshp, double *x, double *tau,
                        double *nrm, double *area);
/* The same with metric, its inverse and curvature, each (ndm-1,ndm-1). */
int bezel_surface_frame(int ndm, int nen, const double *xm, const double *shp, const double *dshp, const double *d2shp,
                        double *x, double *tau, double *nrm, double *metric, double *metric_inv, double *curvature,
                        double *area);

typedef struct {
  double distance;   /* |xs - x(xi)| */
  double xi_free[2]; /* xi, and beyond an overstepped bound Newton's estimate */
  int sides[2];      /* side left in s and in t (1 to 4); 0: none */
  int iterations;
} bezel_projection;

/* Closest point xi(ndm-1) of a facet to xs(ndm). guess = 1: from the first guess in xi; 0: from none. */
int bezel_closest_point(int ndm, const int *degree, int nen, const double *we, const double *ce, const double *xm,
                        const double *xs, int guess, double *xi, bezel_projection *report);

/* ---- solids ---- */

enum bezel_solid_kind {
  bezel_neo_hooke = 1,           /* U = lambda/2 (ln J)^2 */
  bezel_neo_hooke_quadratic = 2, /* U = lambda/4 (J^2 - 1 - 2 ln J) */
  bezel_st_venant = 3,
  bezel_small_strain = 4
};
enum bezel_solid_mode { bezel_plane_strain = 1, bezel_plane_stress = 2, bezel_three_dimensional = 3 };

typedef struct {
  int kind, mode, ndm;
  double e, nu, mu, lambda;
} bezel_solid_law;

/* Fills a law from Young's modulus and Poisson's ratio. */
int bezel_define_solid_law(int kind, int mode, double e, double nu, bezel_solid_law *law);

/* Energy psi, first Piola stress p(ndm,ndm) and its derivative a(ndm,ndm,ndm,ndm) for a deformation gradient f(ndm,ndm). */
int bezel_stress_and_tangent(const bezel_solid_law *law, const double *f, double *psi, double *p, double *a);

/* Once an element: functions shp(nen,ng), reference gradients dshp(ndm,nen,ng) and reference volumes dvol(ng) at the points
 * xi(ndm,ng) with weights wt(ng). */
int bezel_solid_points(int ndm, const int *degree, int nen, const double *xe, const double *we, const double *ce, int ng,
                       const double *xi, const double *wt, double *shp, double *dshp, double *dvol);

/* Force, tangent (blocks a >= b) and energy for the displacements ue(ndm,nen). */
int bezel_solid_tangent(int ndm, int nen, int ng, const double *dshp, const double *dvol, const double *ue,
                        const bezel_solid_law *law, double *fe, double *ke, double *energy);
int bezel_solid_force(int ndm, int nen, int ng, const double *dshp, const double *dvol, const double *ue,
                      const bezel_solid_law *law, double *fe, double *energy);

/* Cauchy stress sigma(6,np) xx, yy, zz, xy, yz, xz at points with reference gradients dshp(ndm,nen,np). */
int bezel_solid_cauchy(int ndm, int nen, int np, const double *dshp, const double *ue, const bezel_solid_law *law,
                       double *sigma);

/* Fills the blocks a < b of ke(ndf,nen,ndf,nen). */
void bezel_mirror(int ndf, int nen, double *ke);

/* ---- Kirchhoff-Love shells: three displacements a node ---- */

typedef struct {
  double c11, c12, c33; /* plane stress stiffness [stress] */
  double nu, thickness;
  int is_linear; /* 1: small strains and rotations */
} bezel_shell_law;

int bezel_define_shell_law(double e, double nu, double thickness, int is_linear, bezel_shell_law *law);

/* Once an element: functions shp(nen,ng), derivatives dshp(5,nen,ng) and frames frame(15,ng) in the tangent planes of the start,
 * reference areas area(ng). The functions must be smooth (C1) within a patch. */
int bezel_shell_points(const int *degree, int nen, const double *xe, const double *we, const double *ce, int ng,
                       const double *xi, const double *wt, double *shp, double *dshp, double *frame, double *area);

/* Force, tangent (blocks a >= b) and energy for the displacements ue(3,nen). */
int bezel_shell_tangent(int nen, int ng, const double *dshp, const double *frame, const double *area, const double *ue,
                        const bezel_shell_law *law, double *fe, double *ke, double *energy);
int bezel_shell_force(int nen, int ng, const double *dshp, const double *frame, const double *area, const double *ue,
                      const bezel_shell_law *law, double *fe, double *energy);

/* Spring [moment per length and angle] against the turning of the angle between two shells A and B along an edge: derivatives
 * dshp(3,nen,ng) along the conormals of A and of B and along the edge, the three tangents start(3,3,ng), lengths, cosine and sine
 * of the angle at the start; ke has the blocks a >= b. */
int bezel_joint_force(int nen, int ng, const double *dshp, const double *start, const double *length, const double *cos_0,
                      const double *sin_0, double stiffness, int is_linear, const double *ue, double *fe, double *ke,
                      double *energy);

/* Moment per length on the side 1 to 4 of an element: derivatives dshp(2,nen,ng) and lengths (ng) at points of the edge. fe is
 * minus the load, ke unsymmetric and complete. */
int bezel_edge_moment(int side, int nen, int ng, const double *xe, const double *ue, const double *dshp, const double *length,
                      double moment, double *fe, double *ke);

/* ---- loads; fe is minus the load. shp(nen,ng) and the parametric derivatives dshp(ndm-1,nen,ng) of a side ---- */

/* traction(ndm,ng) per reference area */
void bezel_dead_traction(int ndm, int nen, int ng, const double *xe, const double *shp, const double *dshp, const double *wt,
                         const double *traction, double *fe);
/* pressure(ng) against the reference normal; positive pushes */
void bezel_dead_pressure(int ndm, int nen, int ng, const double *xe, const double *shp, const double *dshp, const double *wt,
                         const double *pressure, double *fe);
/* pressure(ng) against the current normal; ke is unsymmetric and complete */
void bezel_follower_pressure(int ndm, int nen, int ng, const double *xe, const double *ue, const double *shp,
                             const double *dshp, const double *wt, const double *pressure, double *fe, double *ke);
/* force(ndm,ng) per reference volume; shp and dvol as from bezel_solid_points */
void bezel_body_force(int ndm, int nen, int ng, const double *shp, const double *dvol, const double *force, double *fe);

/* ---- interfaces ---- */

typedef struct {
  double penalty; /* stiffness in compression [stress/length] */
  double p_max;   /* cohesive strength; 0: contact alone */
  double g_max;   /* opening at the strength */
  double g_u;     /* opening at which the point is spent */
  int reversible; /* 1: unloading follows the envelope back */
  double offset;  /* the kernels subtract it from the gap: half the thicknesses of two shells; 0 from the functions below */
} bezel_gap_law;

typedef struct {
  double gap;      /* open > 0 */
  double traction; /* tension > 0 */
  double slope;    /* d traction / d gap */
  double opening;  /* largest opening so far, this state's included: the history, opening_n of the next step */
  double penalty_energy, elastic_energy, dissipated; /* per area; from the kernels integrated with wt */
  double dissipation_slope;                          /* d dissipated / d gap */
} bezel_gap_response;

int bezel_contact_law(double penalty, bezel_gap_law *law);
int bezel_cohesive_law(double penalty, double p_max, double toughness, double g_max, bezel_gap_law *law);
int bezel_cohesive_law_of_stiffness(double penalty, double p_max, double toughness, double stiffness, bezel_gap_law *law);
void bezel_interface_response(const bezel_gap_law *law, double gap, double opening_n, bezel_gap_response *response);

/* One slave Gauss point with functions shp_s(nes), current control points xs(ndm,nes) and weight times reference area wt, at its
 * projection on a master facet with functions shp_m(nem), dshp_m(ndm-1,nem), d2shp_m((ndm-1)*ndm/2,nem; read for the tangent
 * only) and current control points xm(ndm,nem). side = -1 turns the master's normal round. fe(ndm,nes+nem) and, if
 * want_tangent, ke(ndm,nes+nem,ndm,nes+nem), blocks a >= b; slave functions come first. */
int bezel_gpts_point(int ndm, int nes, const double *shp_s, const double *xs, int nem, const double *shp_m,
                     const double *dshp_m, const double *d2shp_m, const double *xm, double side, const bezel_gap_law *law,
                     double opening_n, double wt, int want_tangent, bezel_gap_response *response, double *fe, double *ke);
/* The same where the nearest master point rests on a kink in the directions with held[i] = 1, at least one of ndm-1. */
int bezel_gpts_corner_point(int ndm, int nes, const double *shp_s, const double *xs, int nem, const double *shp_m,
                            const double *dshp_m, const double *d2shp_m, const double *xm, double side, const int *held,
                            const bezel_gap_law *law, double opening_n, double wt, int want_tangent,
                            bezel_gap_response *response, double *fe, double *ke);

#ifdef __cplusplus
}
#endif
#endif
