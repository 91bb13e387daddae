module equation_system
  !! The system of equations of the free control values: dof map, sparse pattern, matrix, and the ways in which element
  !! matrices enter it. Elements of the mesh have their places looked up once for each pattern, interface points (whose
  !! nodes change) at each addition; elements with linked dofs are expanded to the dofs that these depend on.
  use kinds, only: wp
  use status_codes, only: ok, stale_pattern
  use model_data, only: model_type
  use dof_map, only: dof_map_type, build_dof_map, is_linked
  use end_face, only: end_face_geometry
  use user_element, only: mirror
  use sparse_pattern, only: pattern_builder, block_positions, begin_pattern, add_node_lists, add_equation_lists, &
    finish_pattern, locate_blocks, locate_lists
  use sparse_matrix, only: sparse_matrix_type, set_zero, scatter_block_matrix, scatter_unsymmetric_matrix, &
    scatter_linked_matrix
  implicit none (type, external)
  private
  public :: equation_system_type

  type :: equation_system_type
    type(dof_map_type) :: map
    type(sparse_matrix_type) :: matrix
    logical :: symmetric = .true.              !! the matrix holds one triangle
    integer :: stale = 0                       !! additions that found no place since `clear`
    type(pattern_builder), private :: base     !! couplings of the mesh
    type(block_positions), private :: positions !! places of the elements of the mesh
  contains
    procedure :: start
    procedure :: rebuild
    procedure :: clear
    procedure :: add_element
    procedure :: add_loose
    procedure :: add_curvature
  end type equation_system_type

contains

  subroutine start(self, model, faces, symmetric)
    !! Number the equations and note the couplings of the mesh and of the end faces that are free to warp.
    class(equation_system_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    type(end_face_geometry), intent(in) :: faces(:)   !! of model%end_faces
    logical, intent(in) :: symmetric
    integer, allocatable :: pairs(:)
    integer :: a, k

    self%symmetric = symmetric
    call build_dof_map(model, faces, self%map)
    call begin_pattern(self%base, self%map%neq, self%map%first, self%map%count)
    call add_node_lists(self%base, model%mesh%node_ptr(1:model%mesh%ne + 1), &
                        model%mesh%nodes(1:model%mesh%node_ptr(model%mesh%ne + 1) - 1))
    if (size(self%map%links) > 0) call add_link_lists(self, model%mesh%node_ptr(1:model%mesh%ne + 1), &
                                                      model%mesh%nodes, self%base)
    do k = 1, size(faces)
      if (faces(k)%rigid) cycle
      pairs = [(faces(k)%nodes(a), faces(k)%rotation, a=1, size(faces(k)%nodes))]
      call add_node_lists(self%base, [(a, a=1, size(pairs) + 1, 2)], pairs)
      if (size(self%map%links) > 0) call add_link_lists(self, [(a, a=1, size(pairs) + 1, 2)], pairs, self%base)
    end do
  end subroutine start

  subroutine rebuild(self, model, ptr, nodes, status)
    !! Make the pattern of the mesh and of further lists of nodes (interface pairs).
    class(equation_system_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: ptr(:)     !! (lists+1) where each list begins, from 1
    integer, intent(in) :: nodes(:)
    integer, intent(out) :: status
    type(pattern_builder) :: builder

    builder = self%base
    call add_node_lists(builder, ptr, nodes)
    if (size(self%map%links) > 0) call add_link_lists(self, ptr, nodes, builder)
    call finish_pattern(builder, self%symmetric, self%matrix%pattern, status)
    if (status /= ok) return
    call locate_lists(self%matrix%pattern, model%mesh%node_ptr(1:model%mesh%ne + 1), model%mesh%nodes, &
                      self%positions, status)
  end subroutine rebuild

  subroutine add_link_lists(self, ptr, nodes, builder)
    !! Lists with linked dofs couple all the equations that these depend on.
    class(equation_system_type), intent(in) :: self
    integer, intent(in) :: ptr(:), nodes(:)
    type(pattern_builder), intent(inout) :: builder
    integer, allocatable :: terms_ptr(:), terms(:)
    real(wp), allocatable :: coefs(:)
    integer :: l

    do l = 1, size(ptr) - 1
      associate (list => nodes(ptr(l):ptr(l + 1) - 1))
        if (.not. any(self%map%has_link(list))) cycle
        call dependence(self, self%map%ndf, list, terms_ptr, terms, coefs)
        terms = pack(terms, terms > 0)
        call add_equation_lists(builder, [1, size(terms) + 1], terms)
      end associate
    end do
  end subroutine add_link_lists

  subroutine dependence(self, ndf, nodes, ptr, eq, coef)
    !! Each dof of the nodes as a sum of free dofs.
    class(equation_system_type), intent(in) :: self
    integer, intent(in) :: ndf, nodes(:)
    integer, allocatable, intent(out) :: ptr(:)    !! (ndf*nen+1) where the terms of a dof begin
    integer, allocatable, intent(out) :: eq(:)     !! equations, 0 for prescribed dofs
    real(wp), allocatable, intent(out) :: coef(:)
    integer :: a, i, n, e, first, last

    allocate (ptr(ndf*size(nodes) + 1))
    n = 1
    ptr(1) = 1
    do a = 1, size(nodes)
      do i = 1, ndf
        e = self%map%eq(i, nodes(a))
        n = n + 1
        ptr(n) = ptr(n - 1) + 1
        if (is_linked(e)) ptr(n) = ptr(n - 1) + size(self%map%links(-e)%nodes)
      end do
    end do
    allocate (eq(ptr(n) - 1), coef(ptr(n) - 1))
    n = 0
    do a = 1, size(nodes)
      do i = 1, ndf
        e = self%map%eq(i, nodes(a))
        n = n + 1
        first = ptr(n)
        last = ptr(n + 1) - 1
        if (is_linked(e)) then
          associate (d => self%map%links(-e))
            eq(first:last) = equations_of(self%map%eq, d%comps, d%nodes)
            coef(first:last) = d%coefs
          end associate
        else
          eq(first) = e
          coef(first) = 1
        end if
      end do
    end do

  contains

    pure function equations_of(eq, comps, nodes) result(found)
      integer, intent(in) :: eq(:, :), comps(:), nodes(:)
      integer :: found(size(nodes))
      integer :: m

      do m = 1, size(nodes)
        found(m) = eq(comps(m), nodes(m))
      end do
    end function equations_of
  end subroutine dependence

  subroutine clear(self)
    !! Zero matrix, before an assembly.
    class(equation_system_type), intent(inout) :: self
    call set_zero(self%matrix)
    self%stale = 0
  end subroutine clear

  subroutine add_element(self, element, nodes, ke, symmetric)
    !! Add the matrix of an element of the mesh.
    class(equation_system_type), intent(inout) :: self
    integer, intent(in) :: element                            !! its number
    integer, intent(in) :: nodes(:)
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)     !! (ndf,nen,ndf,nen)
    logical, intent(in) :: symmetric                          !! only blocks a >= b are filled
    integer :: n

    n = size(nodes)
    associate (first => self%positions%start(element))
      call scatter(self, nodes, self%positions%offset(first:first + n*n - 1), ke, symmetric)
    end associate
  end subroutine add_element

  subroutine add_loose(self, nodes, ke, symmetric)
    !! Add a matrix whose nodes may change from one assembly to the next.
    class(equation_system_type), intent(inout) :: self
    integer, intent(in) :: nodes(:)
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)     !! (ndf,nen,ndf,nen)
    logical, intent(in) :: symmetric                          !! only blocks a >= b are filled
    integer :: offset(size(nodes), size(nodes)), status

    call locate_blocks(self%matrix%pattern, nodes, offset, status)
    if (status /= ok) then
      self%stale = self%stale + 1
      return
    end if
    call scatter(self, nodes, offset, ke, symmetric)
  end subroutine add_loose

  subroutine add_curvature(self, f)
    !! The second derivatives of points that turn with a rigid face: f . d2u/dtheta2 on the diagonal of its angle.
    class(equation_system_type), intent(inout) :: self
    real(wp), intent(in) :: f(:, :)    !! all nodal forces (ndf,nn)
    integer :: l, e, status

    do l = self%map%linear + 1, size(self%map%links)
      associate (d => self%map%links(l))
        e = self%map%eq(d%comps(2), d%nodes(2))
        if (e <= 0) cycle
        call scatter_linked_matrix(self%matrix, [1, 2], [e], [1.0_wp], reshape([f(d%comp, d%node)*d%curve], [1, 1]), &
                                   status)
      end associate
    end do
  end subroutine add_curvature

  subroutine scatter(self, nodes, offset, ke, symmetric)
    class(equation_system_type), intent(inout) :: self
    integer, intent(in) :: nodes(:), offset(size(nodes), size(nodes))
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)
    logical, intent(in) :: symmetric
    integer :: eq(size(ke, 1), size(nodes)), a, ndf, n, status
    integer, allocatable :: ptr(:), terms(:)
    real(wp), allocatable :: coefs(:)

    ndf = size(ke, 1)
    n = size(nodes)
    if (size(self%map%links) > 0) then
      if (any(self%map%has_link(nodes))) then
        if (symmetric) call mirror(ke)
        call dependence(self, ndf, nodes, ptr, terms, coefs)
        call scatter_linked_matrix(self%matrix, ptr, terms, coefs, reshape(ke, [ndf*n, ndf*n]), status)
        if (status == stale_pattern) self%stale = self%stale + 1
        return
      end if
    end if
    do a = 1, n
      eq(:, a) = self%map%eq(1:ndf, nodes(a))
    end do
    if (symmetric) then
      call scatter_block_matrix(self%matrix, ndf, n, eq, offset, ke, status)
    else
      call scatter_unsymmetric_matrix(self%matrix, ndf, n, eq, offset, ke, status)
    end if
    if (status == stale_pattern) self%stale = self%stale + 1
  end subroutine scatter
end module equation_system
