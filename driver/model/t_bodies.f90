module t_bodies
  !! T-splines become nodes, elements and sets of a model: the surface itself, or the solid that it sweeps.
  use status_codes, only: ok
  use model_data, only: model_type, set_surface
  use model_sets, only: add_set
  use mesh_draft, only: draft_type
  use kinds, only: wp
  use extraction_set, only: extraction_set_type
  use t_mesh, only: t_mesh_type
  use t_spline, only: t_spline_type, t_elements_type, t_spline_extraction
  use t_sweep, only: sweep_type, swept_points, swept_extraction
  implicit none (type, external)
  private
  public :: t_body, add_t_body

  type :: t_body
    integer :: first = 0, last = 0        !! its elements in the model, layer by layer
    integer :: layers = 1                 !! of the sweep
    type(t_elements_type) :: surface      !! elements of the surface
  contains
    procedure :: all_elements
    procedure :: elements_on
    procedure :: through_layers
    procedure, nopass :: add_surface
  end type t_body

contains

  subroutine add_t_body(mesh, spline, sweep, model, draft, body, status)
    !! Control points and elements are added; whoever calls notes materials and makes sets.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline             !! of the mesh
    type(sweep_type), allocatable, intent(in) :: sweep    !! not allocated: the surface itself
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(t_body), intent(out) :: body
    integer, intent(out) :: status
    type(extraction_set_type), target :: flat
    real(wp), allocatable :: points(:, :)
    integer :: a, first_node, first_swept

    status = ok
    body%first = model%mesh%ne + 1
    first_node = draft%nn + 1
    if (allocated(sweep)) then
      body%layers = sweep%knots%elements()
      allocate (points(4, spline%n*sweep%knots%functions()))
      call swept_points(sweep, spline%cp, points)
      call t_spline_extraction(mesh, spline, [(a, a=1, spline%n)], flat, body%surface)
      call swept_extraction(sweep, flat, spline%n, [(a, a=first_node, first_node - 1 + size(points, 2))], model%mesh, &
        first_swept, status)
      if (status /= ok) return
    else
      allocate (points, source=spline%cp)
      call t_spline_extraction(mesh, spline, [(a, a=first_node, first_node - 1 + spline%n)], model%mesh, body%surface)
    end if
    body%last = model%mesh%ne
    do a = 1, size(points, 2)
      call draft%set_node(first_node + a - 1, points(1:model%ndm, a), points(4, a))
    end do
  end subroutine add_t_body

  pure function all_elements(self) result(items)
    class(t_body), intent(in) :: self
    integer, allocatable :: items(:)
    integer :: e

    items = [(e, e=self%first, self%last)]
  end function all_elements

  pure function elements_on(self, side) result(items)
    !! Elements along a side: 1 to 4 of the surface, 5 and 6 the first and the last layer of a sweep.
    class(t_body), intent(in) :: self
    integer, intent(in) :: side
    integer, allocatable :: items(:)
    integer :: e

    select case (side)
    case (5)
      items = [(self%first + e - 1, e=1, self%surface%ne)]
    case (6)
      items = [(self%last - self%surface%ne + e, e=1, self%surface%ne)]
    case default
      associate (list => self%surface%side(side))
        items = self%through_layers(list%id(1:list%n) - self%surface%first + 1)
      end associate
    end select
  end function elements_on

  pure function through_layers(self, places) result(items)
    !! The elements of all layers over some elements of the surface.
    class(t_body), intent(in) :: self
    integer, intent(in) :: places(:)       !! in the surface, from 1
    integer, allocatable :: items(:)
    integer :: k

    items = [(places + (self%first - 1 + self%surface%ne*(k - 1)), k=1, self%layers)]
  end function through_layers

  subroutine add_surface(name, place, side, items, model)
    !! The same side of several elements.
    character(*), intent(in) :: name, place
    integer, intent(in) :: side, items(:)
    type(model_type), intent(inout) :: model

    call add_set(model, name, place, set_surface, items, spread(side, 1, size(items)))
  end subroutine add_surface
end module t_bodies
