module quad_bodies
  !! Surfaces over quadrilateral meshes become nodes and elements of a model: the surface itself, or the solid that it sweeps
  !! (see t_sweep).
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use mesh_draft, only: draft_type
  use extraction_mesh, only: extraction_mesh_type
  use t_sweep, only: sweep_type, swept_points, swept_extraction
  implicit none (type, external)
  private
  public :: quad_body, add_quad_body

  type :: quad_body
    integer :: first = 0, last = 0        !! its elements in the model, layer by layer
    integer :: layers = 1                 !! of the sweep
    integer :: flat = 0                   !! elements of the surface
  contains
    procedure :: layer
    procedure :: through_layers
  end type quad_body

contains

  subroutine add_quad_body(mesh, sweep, model, draft, body, status)
    !! Control points and elements are added; whoever calls notes materials and makes sets.
    type(extraction_mesh_type), intent(in), target :: mesh   !! the surface
    type(sweep_type), allocatable, intent(in) :: sweep       !! not allocated: the surface itself
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(quad_body), intent(out) :: body
    integer, intent(out) :: status                           !! ok, bad_extraction
    real(wp), allocatable :: points(:, :), surface(:, :)
    integer :: a, e, first_swept, id, old_nn

    status = ok
    old_nn = draft%nn
    body%first = model%mesh%ne + 1
    body%flat = mesh%elements%ne
    allocate (surface(4, mesh%nn))
    surface(1:3, :) = mesh%x(:, 1:mesh%nn)
    surface(4, :) = mesh%w(1:mesh%nn)
    if (allocated(sweep)) then
      body%layers = sweep%knots%elements()
      allocate (points(4, mesh%nn*sweep%knots%functions()))
      call swept_points(sweep, surface, points)
      call swept_extraction(sweep, mesh%elements, mesh%nn, [(a, a=old_nn + 1, old_nn + size(points, 2))], model%mesh, &
        first_swept, status)
      if (status /= ok) return
    else
      call move_alloc(surface, points)
      do e = 1, body%flat
        call model%mesh%add_element(2, mesh%elements%degree(1:2, e), mesh%elements%connectivity(e) + old_nn, &
          mesh%elements%operator(e), id)
      end do
    end if
    body%last = model%mesh%ne
    do a = 1, size(points, 2)
      call draft%set_node(old_nn + a, points(1:model%ndm, a), points(4, a))
    end do
  end subroutine add_quad_body

  pure function layer(self, k) result(elements)
    class(quad_body), intent(in) :: self
    integer, intent(in) :: k               !! layer of the sweep
    integer :: elements(self%flat)
    integer :: e

    elements = [(self%first + (k - 1)*self%flat + e - 1, e=1, self%flat)]
  end function layer

  pure function through_layers(self, items) result(elements)
    !! The elements of all layers over some elements of the surface.
    class(quad_body), intent(in) :: self
    integer, intent(in) :: items(:)        !! of the surface, from 1
    integer :: elements(size(items)*self%layers)
    integer :: k

    elements = [(items + (self%first - 1 + self%flat*(k - 1)), k=1, self%layers)]
  end function through_layers
end module quad_bodies
