/* Stiffness of a bilinear unit square in plane stress, E = 1, nu = 0.3, row by row. */
#include <bezel.h>
#include <stdio.h>

int main(void) {
  int degree[2] = {1, 1}, rule[2] = {2, 2}, i, j, status;
  double we[4] = {1, 1, 1, 1}, ce[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, xe[8] = {0, 0, 1, 0, 0, 1, 1, 1};
  double xi[8], wt[4], shp[16], dshp[32], dvol[4], ue[8] = {0}, fe[8], ke[64], energy;
  bezel_solid_law law;

  bezel_tensor_rule(2, rule, xi, wt);
  status = bezel_define_solid_law(bezel_small_strain, bezel_plane_stress, 1, 0.3, &law);
  if (!status) status = bezel_solid_points(2, degree, 4, xe, we, ce, 4, xi, wt, shp, dshp, dvol);
  if (!status) status = bezel_solid_tangent(2, 4, 4, dshp, dvol, ue, &law, fe, ke, &energy);
  if (status) return 1;
  bezel_mirror(2, 4, ke);
  for (i = 0; i < 8; i++)
    for (j = 0; j < 8; j++) printf("%.12f%s", ke[i + 8 * j] + 0.0, j < 7 ? " " : "\n");
  return 0;
}
