module model_sets
  !! Named sets of a model: finding them, the nodes that they hold, surfaces from them, unions.
  !! Names are compared without regard to case. Several sets may have one name if their kinds
  !! differ.
  use kinds, only: wp
  use messages, only: string, lower_case
  use model_data, only: model_type, named_set, set_nodes, set_elements, set_surface, &
    extraction_set_type
  use side_extraction, only: side_functions, side_operator
  implicit none (type, external)
  private
  public :: find_set, find_set_of_kind, set_names, add_set, nodes_of_set, used_nodes, as_surface, &
    unite_sets, &
    common_nodes, sorted_unique

contains

  integer function find_set(model, name)
    !! Index of the first set of this name; 0 if there is none.
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name

    do find_set = 1, size(model%sets)
      if (same_name(model%sets(find_set)%name, name)) return
    end do
    find_set = 0
  end function find_set

  integer function find_set_of_kind(model, name, kind)
    !! Index of the set of this name and kind; 0 if there is none.
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name
    integer, intent(in) :: kind       !! set_nodes, set_elements, set_surface

    do find_set_of_kind = 1, size(model%sets)
      if (model%sets(find_set_of_kind)%kind /= kind) cycle
      if (same_name(model%sets(find_set_of_kind)%name, name)) return
    end do
    find_set_of_kind = 0
  end function find_set_of_kind

  pure logical function same_name(a, b)
    character(*), intent(in) :: a, b

    same_name = len(a) == len(b)
    if (same_name) same_name = lower_case(a) == lower_case(b)
  end function same_name

  function set_names(model, kind) result(names)
    !! For messages.
    type(model_type), intent(in) :: model
    integer, intent(in) :: kind              !! only sets of this kind; 0: all
    type(string), allocatable :: names(:)
    integer :: i, n

    n = count([(kind == 0 .or. model%sets(i)%kind == kind, i = 1, size(model%sets))])
    allocate (names(n))
    n = 0
    do i = 1, size(model%sets)
      if (kind /= 0 .and. model%sets(i)%kind /= kind) cycle
      n = n + 1
      names(n)%s = model%sets(i)%name
    end do
  end function set_names

  subroutine add_set(model, name, place, kind, items, sides)
    type(model_type), intent(inout) :: model
    character(*), intent(in) :: name          !! as the deck writes it
    character(*), intent(in) :: place         !! file:line
    integer, intent(in) :: kind               !! set_nodes, set_elements, set_surface
    integer, intent(in) :: items(:)           !! nodes, elements, or the elements of a surface
    integer, intent(in) :: sides(:)           !! side of each element of a surface; else empty
    type(named_set), allocatable :: larger(:)
    integer :: i, n

    n = size(model%sets)
    allocate (larger(n + 1))
    do i = 1, n
      larger(i)%kind = model%sets(i)%kind
      call move_alloc(model%sets(i)%name, larger(i)%name)
      call move_alloc(model%sets(i)%place, larger(i)%place)
      call move_alloc(model%sets(i)%items, larger(i)%items)
      call move_alloc(model%sets(i)%sides, larger(i)%sides)
    end do
    larger(n + 1)%name = name
    larger(n + 1)%place = place
    larger(n + 1)%kind = kind
    larger(n + 1)%items = items
    larger(n + 1)%sides = sides
    call move_alloc(larger, model%sets)
  end subroutine add_set

  function nodes_of_set(model, index) result(nodes)
    !! The nodes themselves; all nodes of elements; of a surface those whose function does not
    !! vanish on it.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: index             !! into model%sets
    integer, allocatable :: nodes(:)         !! increasing, each once
    integer, pointer, contiguous :: ix(:)
    integer, allocatable :: list(:), rows(:)
    integer :: i, n, total

    associate (set => model%sets(index))
      if (set%kind == set_nodes) then
        nodes = sorted_unique(set%items, model%nn)
        return
      end if
      total = 0
      do i = 1, size(set%items)
        total = total + model%mesh%nen(set%items(i))
      end do
      allocate (list(total))
      n = 0
      do i = 1, size(set%items)
        ix => model%mesh%connectivity(set%items(i))
        if (set%kind == set_elements) then
          list(n + 1:n + size(ix)) = ix
          n = n + size(ix)
        else
          call rows_on_side(model%mesh, set%items(i), set%sides(i), rows)
          list(n + 1:n + size(rows)) = ix(rows)
          n = n + size(rows)
        end if
      end do
    end associate
    nodes = sorted_unique(list(1:n), model%nn)
  end function nodes_of_set

  subroutine rows_on_side(mesh, e, side, rows)
    !! Functions of an element that do not vanish on its side.
    type(extraction_set_type), intent(in), target :: mesh
    integer, intent(in) :: e                           !! element
    integer, intent(in) :: side                        !! 0: the element itself
    integer, allocatable, intent(out) :: rows(:)
    real(wp), pointer, contiguous :: ce(:, :)
    real(wp), allocatable :: ce_side(:, :)
    integer, allocatable :: all_rows(:)
    integer :: degree(3), side_degree(2), dp, n, a

    if (side == 0) then
      rows = [(a, a = 1, mesh%nen(e))]
      return
    end if
    dp = mesh%dp(e)
    degree = mesh%degree(:, e)
    ce => mesh%operator(e)
    allocate (all_rows(size(ce, 1)), ce_side(size(ce, 1), side_functions(degree(1:dp), side)))
    call side_operator(degree(1:dp), ce, side, side_degree(1:dp - 1), n, all_rows, ce_side)
    rows = all_rows(1:n)
  end subroutine rows_on_side

  subroutine used_nodes(model, used)
    !! Nodes that some element names.
    type(model_type), intent(in) :: model
    logical, allocatable, intent(out) :: used(:)   !! (nn)
    integer :: k

    allocate (used(model%nn), source=.false.)
    if (model%mesh%ne == 0) return
    do k = 1, model%mesh%node_ptr(model%mesh%ne + 1) - 1
      used(model%mesh%nodes(k)) = .true.
    end do
  end subroutine used_nodes

  subroutine as_surface(model, index)
    !! A set of elements one dimension below space (shells) is a surface as it stands: a set of that
    !! kind is added.
    type(model_type), intent(inout) :: model
    integer, intent(inout) :: index      !! of a set; of a surface on return, 0 if it cannot be one
    integer :: i

    if (model%sets(index)%kind == set_surface) return
    i = find_set_of_kind(model, model%sets(index)%name, set_surface)
    if (i == 0 .and. model%sets(index)%kind == set_elements) then
      associate (set => model%sets(index))
        if (all(model%mesh%dp(set%items) == model%ndm - 1)) i = -1
      end associate
      if (i < 0) then
        call add_set(model, model%sets(index)%name, model%sets(index)%place, set_surface, &
          model%sets(index)%items, &
          0*model%sets(index)%items)
        i = size(model%sets)
      end if
    end if
    index = i
  end subroutine as_surface

  subroutine unite_sets(model, indices, kind, items, sides)
    !! The union of sets of one kind is of that kind; of different kinds, the union of their nodes.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: indices(:)                      !! sets, at least one
    integer, intent(out) :: kind                           !! set_nodes, set_elements, set_surface
    integer, allocatable, intent(out) :: items(:), sides(:)
    integer, allocatable :: keys(:)
    integer :: i

    kind = model%sets(indices(1))%kind
    do i = 2, size(indices)
      if (model%sets(indices(i))%kind /= kind) kind = set_nodes
    end do
    allocate (items(0), sides(0))
    do i = 1, size(indices)
      associate (set => model%sets(indices(i)))
        if (kind == set_nodes) then
          items = [items, nodes_of_set(model, indices(i))]
        else
          items = [items, set%items]
          if (kind == set_surface) sides = [sides, set%sides]
        end if
      end associate
    end do
    select case (kind)
    case (set_nodes)
      items = sorted_unique(items, model%nn)
    case (set_elements)
      items = sorted_unique(items, model%mesh%ne)
    case (set_surface)
      keys = sorted_unique(7*items + sides, 7*model%mesh%ne + 6)  ! sides are 0 to 6
      items = keys/7
      sides = mod(keys, 7)
    end select
  end subroutine unite_sets

  subroutine common_nodes(model, indices, nodes)
    !! Nodes that all of the sets hold (the corner of two surfaces).
    type(model_type), intent(in), target :: model
    integer, intent(in) :: indices(:)
    integer, allocatable, intent(out) :: nodes(:)   !! increasing
    integer, allocatable :: times(:)
    integer :: i

    allocate (times(model%nn), source=0)
    do i = 1, size(indices)
      associate (list => nodes_of_set(model, indices(i)))
        times(list) = times(list) + 1
      end associate
    end do
    nodes = pack([(i, i = 1, model%nn)], times == size(indices))
  end subroutine common_nodes

  pure function sorted_unique(list, largest) result(unique)
    !! By counting: the numbers are those of nodes or elements.
    integer, intent(in) :: list(:)         !! numbers from 1 to largest
    integer, intent(in) :: largest
    integer, allocatable :: unique(:)      !! increasing, each once
    logical, allocatable :: there(:)
    integer :: i, n

    allocate (there(largest), source=.false.)
    there(list) = .true.
    allocate (unique(count(there)))
    n = 0
    do i = 1, largest
      if (.not. there(i)) cycle
      n = n + 1
      unique(n) = i
    end do
  end function sorted_unique
end module model_sets
