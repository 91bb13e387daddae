module status_codes
  !! Expected failures of shape routines and kernels, as named values. Zero is success; a kernel never stops
  !! and never prints, its caller decides (cut the step back, refuse the deck, return PNEWDT < 1, ...).
  implicit none (type, external)
  private
  public :: ok, inverted_element, singular_map, outside_facet, singular_projection, no_convergence, bad_weight, &
    bad_knots, not_symmetric, bad_law_data, law_failed, &
    bad_extraction, node_out_of_range, not_finite
  public :: stale_pattern, singular_matrix, not_positive_definite, out_of_memory
  public :: bad_t_mesh, not_suitable, edges_differ
  public :: bond_lost, nothing_bonded
  public :: outside_patch
  public :: wrong_dimension
  public :: side_unknown
  public :: too_thick
  public :: status_text

  integer, parameter :: ok = 0
  integer, parameter :: inverted_element = 1     !! det J or det F is not positive
  integer, parameter :: singular_map = 2         !! tangents of a facet are parallel or vanish
  integer, parameter :: outside_facet = 3        !! the projection lies beyond the facet's bounds
  integer, parameter :: singular_projection = 4  !! the point is at a centre of curvature of the facet
  integer, parameter :: no_convergence = 5       !! an inner iteration did not converge
  integer, parameter :: bad_weight = 6           !! the weight function is not positive
  integer, parameter :: bad_knots = 7            !! a knot vector decreases or repeats a knot too often
  integer, parameter :: not_symmetric = 8        !! a tangent that was announced as symmetric is not
  integer, parameter :: bad_law_data = 9         !! law parameters outside their admissible range
  integer, parameter :: law_failed = 10          !! the constitutive iteration (plane stress) failed
  integer, parameter :: bad_extraction = 11     !! operator, degrees and connectivity of an element do not fit
  integer, parameter :: node_out_of_range = 12  !! a connectivity names a node that does not exist
  integer, parameter :: not_finite = 13         !! a coefficient is infinite or not a number
  integer, parameter :: stale_pattern = 14  !! the sparse pattern lacks an entry and must be built anew
  integer, parameter :: singular_matrix = 15  !! the matrix is singular to working precision
  integer, parameter :: not_positive_definite = 16  !! a pivot of the Cholesky factorisation is not positive
  integer, parameter :: out_of_memory = 17  !! the memory does not suffice
  integer, parameter :: bad_t_mesh = 18  !! degrees or lines that a T-mesh does not support
  integer, parameter :: not_suitable = 19  !! the extensions of two T-junctions cross
  integer, parameter :: edges_differ = 20  !! two edges to be merged are not the same curve
  integer, parameter :: bond_lost = 21  !! a bonded point has left the master's edge by more than a facet
  integer, parameter :: nothing_bonded = 22  !! no Gauss point lies in the bonded part of an interface
  integer, parameter :: outside_patch = 23  !! a slave point has left the master facets that its element knows
  integer, parameter :: wrong_dimension = 24  !! an element formulation on elements of another dimension
  integer, parameter :: side_unknown = 25  !! the gap at the start does not tell on which side of a shell the slave is
  integer, parameter :: too_thick = 26  !! layers of a shell lie beyond its centre of curvature

contains

  pure function status_text(status) result(text)
    integer, intent(in) :: status        !! one of the codes above
    character(:), allocatable :: text    !! what happened, without place

    select case (status)
    case (ok);                  text = 'ok'
    case (inverted_element);    text = 'the element is inverted (its Jacobian determinant is not positive)'
    case (singular_map);        text = 'the tangents of the surface vanish or are parallel'
    case (outside_facet);       text = 'the projection lies beyond the bounds of the facet'
    case (singular_projection); text = 'the point lies at a centre of curvature of the facet'
    case (no_convergence);      text = 'the local iteration did not converge'
    case (bad_weight);          text = 'the weight function is not positive'
    case (bad_knots);           text = 'the knot vector decreases or repeats a knot too often'
    case (not_symmetric);       text = 'the tangent is not symmetric'
    case (bad_law_data);        text = 'the law parameters are outside their admissible range'
    case (law_failed);          text = 'the constitutive iteration failed'
    case (bad_extraction);      text = 'the extraction operator does not fit the degrees and the nodes of the element'
    case (node_out_of_range);   text = 'the connectivity names a node that does not exist'
    case (not_finite);          text = 'a coefficient is infinite or not a number'
    case (stale_pattern); text = 'the sparse pattern lacks an entry and must be built anew'
    case (singular_matrix); text = 'the matrix is singular to working precision'
    case (not_positive_definite); text = 'the matrix is not positive definite'
    case (out_of_memory); text = 'the memory does not suffice'
    case (bad_t_mesh); text = 'the T-mesh does not support these degrees, lines or splits'
    case (not_suitable); text = 'the T-mesh is not analysis-suitable: the extensions of two T-junctions cross'
    case (edges_differ); text = 'the edges to be merged are not the same curve'
    case (bond_lost); text = 'a bonded point has slid beyond the edge of the master surface by more than the length of a '// &
      'facet. Let the master surface reach farther, or bond less of the slave surface'
    case (nothing_bonded); text = 'no Gauss point of it is bonded: none lies in a BONDed part, outside every UNBOnded '// &
      'part, opposite to the master and nearer to it than the opening at which it is spent'
    case (outside_patch); text = 'a slave point has left the master facets that its element knows (PATCH)'
    case (wrong_dimension);     text = 'the element type is made for another parametric dimension (surfaces in space take SHELl)'
    case (side_unknown); text = 'at the start its points lie on both sides of the master shell, or on none. Let the normals of '// &
      'its patches, t_1 x t_2, point to the same side, and write SIDE=1, or SIDE=-1 where the slave lies on the other side'
    case (too_thick); text = 'half the thickness of the shell is more than a radius of its curvature: its layers (POINts) intersect'
    case default;               text = 'unknown status'
    end select
  end function status_text
end module status_codes
