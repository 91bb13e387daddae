module unstructured_spline
  !! Splines over quadrilateral control meshes of any topology, as elements with extraction
  !! operators, one element a face: bicubic and C2 where the mesh is regular, with one tangent plane
  !! along the seams of extraordinary points (seam_lines) and C1 across the lines that end on them
  !! in the two rows of faces beside a seam; bi-quartic in the faces of compact points
  !! (extraordinary_ring), C1 across the edges around these.
  !!
  !! Linear independence: the inner coefficients of a face beside no seam determine its four
  !! functions
  !! (the matrix of knot insertion is regular); next to seams and in irregular faces they are
  !! control points themselves, and so are, in Bezier form, the ends of traces and the planes.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type
  use quad_mesh, only: quad_mesh_type, face_of
  use seam_lines, only: find_seams
  use spline_slots, only: number_slots
  use sparse_row, only: row_type, clear, add_term
  use spline_rows, only: spline_space_type, start_ring, cubic_coefficients
  use extraordinary_ring, only: ring_type, ring_coefficients
  implicit none (type, external)
  private
  public :: unstructured_spline_type, create_spline, spline_mesh, side_of_edge, first_corner, &
    coefficient, coefficients_of

  type, extends(spline_space_type) :: unstructured_spline_type
    integer, allocatable :: degree(:)            !! of each element, in both directions (nf)
    real(wp), allocatable :: cp(:,:)             !! control points (3,slots%n) [length]
    type(row_type), allocatable :: b(:,:)        !! Bezier coefficients of each element (25,nf)
  end type unstructured_spline_type

contains

  subroutine create_spline(mesh, spline, message)
    !! The functions. Control points are left at the origin.
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type), intent(out) :: spline
    character(:), allocatable, intent(out) :: message    !! what is not supported; empty: nothing

    integer :: f, v

    spline%mesh = mesh
    call find_seams(spline%mesh)
    call number_slots(spline%mesh, spline%slots, message)
    if (len(message) > 0) return
    allocate (spline%degree(mesh%nf), source=3)
    allocate (spline%cp(3,spline%slots%n), source=0.0_wp)
    allocate (spline%b(25,mesh%nf))
    do f = 1, mesh%nf
      if (spline%slots%irregular(f) == 0) call regular_face(spline, f)
    end do
    do v = 1, mesh%nv
      if (spline%mesh%compact(v)) call irregular_faces(spline, v)
    end do
  end subroutine create_spline

  pure integer function first_corner(spline, f)
    !! The corner at the origin of an element: an extraordinary point, or the face's first corner.
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: f                     !! element

    first_corner = merge(spline%slots%irregular(f), 4*f - 3, spline%slots%irregular(f) > 0)
  end function first_corner

  pure integer function side_of_edge(spline, c)
    !! Side of an element: 1: s=0, 2: s=1, 3: t=0, 4: t=1.
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner that an edge of the element starts from

    integer, parameter :: sides(0:3) = [3, 2, 4, 1]

    side_of_edge = sides(modulo(c - first_corner(spline, face_of(c)), 4))
  end function side_of_edge

  subroutine regular_face(spline, f)
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: f                     !! element

    type(row_type) :: b(0:3,0:3)
    integer :: i, j

    call cubic_coefficients(spline, 4*f - 3, .true., b)
    spline%degree(f) = 3
    do j = 0, 3
      do i = 0, 3
        spline%b(1+i+4*j,f) = b(i,j)
      end do
    end do
  end subroutine regular_face

  subroutine irregular_faces(spline, v)
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: v                     !! extraordinary point

    type(ring_type) :: ring
    type(row_type), allocatable :: f(:,:,:)
    type(row_type) :: b(0:3,0:3)
    integer :: c, i, j, k

    call start_ring(spline, v, ring)
    c = spline%mesh%corner(v)
    do k = 1, ring%n
      call cubic_coefficients(spline, c, .false., b)
      do j = 0, 3
        do i = 0, 3
          ring%b(i,j,k) = b(i,j)
        end do
      end do
      c = spline%mesh%turn(c)
    end do
    call ring_coefficients(ring, f)
    do k = 1, ring%n
      spline%degree(face_of(c)) = 4
      do j = 0, 4
        do i = 0, 4
          spline%b(1+i+5*j,face_of(c)) = f(i,j,k)
        end do
      end do
      c = spline%mesh%turn(c)
    end do
  end subroutine irregular_faces

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
