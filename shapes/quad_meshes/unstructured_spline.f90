module unstructured_spline
  !! Splines over quadrilateral control meshes of any topology, as elements with extraction
  !! operators, one element a face: bicubic and C2 where the mesh is regular, with one tangent plane
  !! along the seams of extraordinary points (seam_lines) and C1 across the lines that end on them
  !! in the two rows of faces beside a seam. Faces beside short seams are bi-quartic.
  !!
  !! Linear independence: the inner coefficients of a face beside no seam determine its four
  !! functions (the matrix of knot insertion is regular); next to seams they are control points
  !! themselves, and so are, in Bezier form, the ends of traces and the planes. What short seams add
  !! follows from their traces.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type
  use quad_mesh, only: quad_mesh_type, face_of
  use seam_lines, only: find_seams
  use spline_slots, only: number_slots
  use sparse_row, only: row_type, clear, add_term, add_row
  use spline_rows, only: spline_space_type, cubic_coefficients, quartic_rest
  implicit none (type, external)
  private
  public :: unstructured_spline_type, create_spline, spline_mesh, side_of_edge, coefficient, &
    coefficients_of, corner_point

  type, extends(spline_space_type) :: unstructured_spline_type
    integer, allocatable :: degree(:)            !! of each element, in both directions (nf)
    real(wp), allocatable :: cp(:,:)             !! control points (3,slots%n) [length]
    type(row_type), allocatable :: b(:,:)        !! Bezier coefficients of each element (25,nf)
  end type unstructured_spline_type

contains

  subroutine create_spline(mesh, spline, message)
    !! The functions. Control points are left at the origin. Seams are laid unless the mesh has
    !! them.
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type), intent(out) :: spline
    character(:), allocatable, intent(out) :: message    !! what is not supported; empty: nothing

    integer :: f

    spline%mesh = mesh
    if (.not. mesh%has_seams) call find_seams(spline%mesh)
    call number_slots(spline%mesh, spline%slots, message)
    if (len(message) > 0) return
    allocate (spline%degree(mesh%nf), source=3)
    allocate (spline%cp(3,spline%slots%n), source=0.0_wp)
    allocate (spline%b(25,mesh%nf))
    do f = 1, mesh%nf
      call set_face(spline, f)
    end do
  end subroutine create_spline

  pure integer function side_of_edge(c)
    !! Side of an element: 1: s=0, 2: s=1, 3: t=0, 4: t=1.
    integer, intent(in) :: c                     !! corner that an edge of the element starts from

    integer, parameter :: sides(4) = [3, 2, 4, 1]

    side_of_edge = sides(c - 4*face_of(c) + 4)
  end function side_of_edge

  subroutine set_face(spline, f)
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: f                     !! element

    type(row_type) :: b(0:3,0:3)
    integer :: i, j

    call cubic_coefficients(spline, 4*f - 3, b)
    if (any(abs(spline%mesh%bend(4*f-3:4*f)) > 0)) then
      call set_quartic_face(spline, f, b)
    else
      do j = 0, 3
        do i = 0, 3
          spline%b(1+i+4*j,f) = b(i,j)
        end do
      end do
    end if
  end subroutine set_face

  subroutine set_quartic_face(spline, f, cubic)
    !! Beside short seams.
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: f                     !! element
    type(row_type), intent(in) :: cubic(0:3,0:3)

    integer, parameter :: middle(4) = [8, 14, 18, 12]   ! inside at the edges from corners 1 ... 4
    type(row_type) :: raised(0:4,0:3)
    integer :: i, j

    spline%degree(f) = 4
    do j = 0, 3
      call raise(cubic(:,j), raised(:,j))
    end do
    do i = 0, 4
      call raise(raised(i,:), spline%b(1+i:21+i:5,f))
    end do
    call quartic_rest(spline, 4*f - 3, cubic(:,0), spline%b(middle(1),f))
    call quartic_rest(spline, 4*f - 2, cubic(3,:), spline%b(middle(2),f))
    call quartic_rest(spline, 4*f - 1, cubic(3:0:-1,3), spline%b(middle(3),f))
    call quartic_rest(spline, 4*f, cubic(0,3:0:-1), spline%b(middle(4),f))
  end subroutine set_quartic_face

  pure subroutine raise(cubic, quartic)
    !! The same polynomial in degree 4.
    type(row_type), intent(in) :: cubic(0:)
    type(row_type), intent(inout) :: quartic(0:)

    integer :: k

    do k = 0, 4
      call clear(quartic(k))
    end do
    do k = 0, 3
      call add_row(quartic(k), 1 - 0.25_wp*k, cubic(k))
      call add_row(quartic(k+1), 0.25_wp*(k + 1), cubic(k))
    end do
  end subroutine raise

  subroutine spline_mesh(spline, mesh)
    !! Control points and elements; no sets.
    type(unstructured_spline_type), intent(in) :: spline
    type(extraction_mesh_type), intent(inout) :: mesh

    integer, allocatable :: nodes(:)
    real(wp), allocatable :: ce(:,:)
    integer :: a, f

    call mesh%start('')
    do a = 1, spline%slots%n
      call mesh%add_node(spline%cp(:,a), 1.0_wp, 0)
    end do
    do f = 1, spline%mesh%nf
      call element_operator(spline, f, nodes, ce)
      call mesh%add_element(spread(spline%degree(f), 1, 2), nodes, ce, 0)
    end do
    call mesh%finish()
  end subroutine spline_mesh

  subroutine element_operator(spline, f, nodes, ce)
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: f                             !! element
    integer, allocatable, intent(out) :: nodes(:)        !! its control points (nen)
    real(wp), allocatable, intent(out) :: ce(:,:)        !! extraction operator (nen,nb)

    real(wp), parameter :: rounding = 1e-14_wp           ! what cancels is zero
    type(row_type) :: all_points
    integer :: j, k, nb

    nb = (spline%degree(f) + 1)**2
    call clear(all_points)
    do j = 1, nb
      do k = 1, spline%b(j,f)%n
        if (abs(spline%b(j,f)%c(k)) > rounding) call add_term(all_points, spline%b(j,f)%id(k))
      end do
    end do
    allocate (nodes(all_points%n), source=all_points%id(1:all_points%n))
    allocate (ce(size(nodes),nb), source=0.0_wp)
    do j = 1, nb
      do k = 1, spline%b(j,f)%n
        if (abs(spline%b(j,f)%c(k)) > rounding) &
          ce(findloc(nodes, spline%b(j,f)%id(k), dim=1),j) = spline%b(j,f)%c(k)
      end do
    end do
  end subroutine element_operator

  function coefficient(spline, f, k) result(x)
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: f, k                   !! element, number of a Bezier coefficient
    real(wp) :: x(3)                              !! its place

    integer :: j

    x = 0
    associate (row => spline%b(k,f))
      do j = 1, row%n
        x = x + row%c(j)*spline%cp(:,row%id(j))
      end do
    end associate
  end function coefficient

  function corner_point(spline, c) result(x)
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: c                      !! corner
    real(wp) :: x(3)                              !! its place on the surface

    integer :: p

    p = spline%degree(face_of(c))
    select case (c - 4*face_of(c))
    case (-3); x = coefficient(spline, face_of(c), 1)
    case (-2); x = coefficient(spline, face_of(c), p + 1)
    case (-1); x = coefficient(spline, face_of(c), (p + 1)**2)
    case (0);  x = coefficient(spline, face_of(c), p*(p + 1) + 1)
    end select
  end function corner_point

  subroutine coefficients_of(spline, f, b)
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: f                      !! element
    real(wp), allocatable, intent(out) :: b(:,:)  !! its Bezier coefficients (3,nb)

    integer :: k

    allocate (b(3,(spline%degree(f)+1)**2))
    do k = 1, size(b, 2)
      b(:,k) = coefficient(spline, f, k)
    end do
  end subroutine coefficients_of
end module unstructured_spline
