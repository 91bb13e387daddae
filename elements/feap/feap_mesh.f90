module feap_mesh
  !! The elements of FEAP's mesh that have extraction operators, in FEAP's numbering of nodes and elements, with control
  !! weights and named surfaces. The mesh commands fill it twice: once while FEAP counts, once while it stores.
  use kinds, only: wp
  use extraction_set, only: extraction_set_type
  use extraction_mesh, only: extraction_mesh_type, problem_list, mesh_set, set_of_elements, set_of_sides, whole_number
  use extraction_file, only: read_extraction_file
  use feap_host, only: fail
  implicit none (type, external)
  private
  public :: begin_pass, add_file, add_element, add_operator, add_surface, set_weight, weights_of, find_operator
  public :: pass, mesh, operators, element_of, last_node, last_element, number_of_surfaces, surface_name, find_surface, has_operator

  type(extraction_set_type), target, save :: mesh        !! elements with their operators
  integer, allocatable, save :: element_of(:)            !! element of `mesh` that FEAP's element is; 0: none
  real(wp), allocatable, save :: weight(:)               !! of FEAP's nodes
  type(mesh_set), allocatable, save, target :: surface(:) !! sides, with FEAP's element numbers
  integer, save :: last_node = 0, last_element = 0       !! numbers given so far
  integer, allocatable, save :: operators(:, :)          !! (2,:) number of an OPERator in the deck and in `mesh`
  logical, save :: counting = .false.
  integer, save :: pass = 0                              !! passes over decks begun so far

contains

  subroutine begin_pass(is_counting)
    !! Called by each command: a new pass over the deck begins with empty hands.
    logical, intent(in) :: is_counting

    if (allocated(surface) .and. (is_counting .eqv. counting)) return
    counting = is_counting
    pass = pass + 1
    call mesh%init()
    if (allocated(element_of)) deallocate (element_of, weight, operators)
    if (allocated(surface)) deallocate (surface)
    allocate (element_of(0), weight(0), operators(2, 0), surface(0))
    last_node = 0
    last_element = 0
  end subroutine begin_pass

  subroutine add_file(path, ndm, first_node, first_element, file)
    !! Nodes, elements and sets of a file, numbered on from those before. Its sets of elements are surfaces, if these are
    !! shells.
    character(*), intent(in) :: path
    integer, intent(in) :: ndm                           !! space dimension
    integer, intent(in) :: first_node, first_element     !! least numbers, as *NOD and *ELE have it
    type(extraction_mesh_type), intent(out), target :: file
    type(problem_list) :: problems
    integer :: e, id, node_shift, element_shift

    call read_extraction_file(path, file, problems)
    if (problems%count > 0) then
      associate (first => problems%list(1))
        if (first%line > 0) call fail(path//':'//whole_number(first%line)//': '//first%fact//'. '//first%remedy)
        call fail(path//': '//first%fact//'. '//first%remedy)
      end associate
    end if
    node_shift = max(last_node, first_node - 1)
    element_shift = max(last_element, first_element - 1)
    do e = 1, file%elements%ne
      call add_element(element_shift + e, file%elements%degree(1:file%elements%dp(e), e), &
        file%elements%connectivity(e) + node_shift, ce=file%elements%operator(e), id=id)
    end do
    do e = 1, file%nn
      call set_weight(node_shift + e, file%w(e))
    end do
    do e = 1, size(file%sets)
      if (file%sets(e)%kind == set_of_sides) &
        call add_surface(file%sets(e)%name, file%sets(e)%items + element_shift, file%sets(e)%sides)
      if (file%sets(e)%kind /= set_of_elements) cycle
      if (all(file%elements%dp(file%sets(e)%items) == ndm - 1)) &
        call add_surface(file%sets(e)%name, file%sets(e)%items + element_shift, spread(0, 1, size(file%sets(e)%items)))
    end do
    last_node = node_shift + file%nn
  end subroutine add_file

  subroutine add_element(number, degree, nodes, op, ce, id)
    integer, intent(in) :: number                        !! in FEAP
    integer, intent(in) :: degree(:)                     !! (dp)
    integer, intent(in) :: nodes(:)                      !! FEAP's numbers (nen)
    integer, intent(in), optional :: op                  !! operator of `mesh`, or ...
    real(wp), intent(in), optional :: ce(:, :)           !! ... coefficients (nen,nb)
    integer, intent(out) :: id

    if (present(op)) then
      call mesh%add_element_with_operator(size(degree), degree, nodes, op, id)
    else
      call mesh%add_element(size(degree), degree, nodes, ce, id)
    end if
    call grow(element_of, number)
    if (element_of(number) /= 0) call fail('element '//whole_number(number)// &
      ' is given twice. Number the elements that follow by *ELE=n or by their own records')
    element_of(number) = id
    last_element = max(last_element, number)
  end subroutine add_element

  subroutine add_operator(number, ce)
    integer, intent(in) :: number                        !! in the deck
    real(wp), intent(in) :: ce(:, :)                     !! (nen,nb)
    integer, allocatable :: longer(:, :)
    integer :: op

    if (find_operator(number) > 0) call fail('OPERator '//whole_number(number)//' is given twice. Take another number')
    call mesh%add_operator(ce, op)
    allocate (longer(2, size(operators, 2) + 1))
    longer(:, 1:size(operators, 2)) = operators
    longer(:, size(longer, 2)) = [number, op]
    call move_alloc(longer, operators)
  end subroutine add_operator

  pure integer function find_operator(number)
    integer, intent(in) :: number                        !! in the deck
    integer :: i

    find_operator = 0
    do i = 1, size(operators, 2)
      if (operators(1, i) == number) find_operator = operators(2, i)
    end do
  end function find_operator

  subroutine add_surface(name, elements, sides)
    character(*), intent(in) :: name
    integer, intent(in) :: elements(:), sides(:)         !! FEAP's elements; side of each, 0 the element itself
    type(mesh_set), allocatable :: longer(:)
    integer :: i, n

    n = size(surface)
    allocate (longer(n + 1))
    do i = 1, n
      longer(i)%kind = surface(i)%kind
      call move_alloc(surface(i)%name, longer(i)%name)
      call move_alloc(surface(i)%items, longer(i)%items)
      call move_alloc(surface(i)%sides, longer(i)%sides)
    end do
    longer(n + 1)%kind = set_of_sides
    longer(n + 1)%name = name
    allocate (longer(n + 1)%items, source=elements)
    allocate (longer(n + 1)%sides, source=sides)
    call move_alloc(longer, surface)
  end subroutine add_surface

  subroutine find_surface(name, elements, sides)
    !! Its elements in `mesh` and their sides; a name that is not known ends the run.
    character(*), intent(in) :: name
    integer, allocatable, intent(out) :: elements(:), sides(:)
    character(:), allocatable :: known
    integer :: i

    known = ''
    do i = 1, size(surface)
      known = known//' '//surface(i)%name
      if (lower(surface(i)%name) /= lower(name)) cycle
      allocate (sides, source=surface(i)%sides)
      allocate (elements, source=element_of(surface(i)%items))
      return
    end do
    if (known == '') known = ' none; give one by SURFace name'
    call fail('there is no surface "'//name//'". Known surfaces:'//known)
  end subroutine find_surface

  pure integer function number_of_surfaces()
    number_of_surfaces = size(surface)
  end function number_of_surfaces

  pure function surface_name(i) result(name)
    integer, intent(in) :: i
    character(:), allocatable :: name

    name = surface(i)%name
  end function surface_name

  pure function lower(text)
    character(*), intent(in) :: text
    character(len(text)) :: lower
    integer :: i

    lower = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower

  subroutine set_weight(node, w)
    integer, intent(in) :: node                          !! FEAP's number
    real(wp), intent(in) :: w
    real(wp), allocatable :: longer(:)

    if (node > size(weight)) then
      allocate (longer(max(node, 2*size(weight))), source=1.0_wp)
      longer(1:size(weight)) = weight
      call move_alloc(longer, weight)
    end if
    weight(node) = w
  end subroutine set_weight

  pure subroutine weights_of(nodes, we)
    integer, intent(in) :: nodes(:)
    real(wp), intent(out) :: we(:)                       !! 1 where none is given
    integer :: a

    do a = 1, size(nodes)
      we(a) = 1
      if (nodes(a) <= size(weight)) we(a) = weight(nodes(a))
    end do
  end subroutine weights_of

  pure logical function has_operator(number)
    integer, intent(in) :: number                        !! FEAP's element

    has_operator = .false.
    if (.not. allocated(element_of)) return
    if (number <= size(element_of)) has_operator = element_of(number) > 0
  end function has_operator

  pure subroutine grow(array, needed)
    integer, allocatable, intent(inout) :: array(:)      !! keeps its content, new items are 0
    integer, intent(in) :: needed
    integer, allocatable :: longer(:)

    if (needed <= size(array)) return
    allocate (longer(max(needed, 2*size(array))), source=0)
    longer(1:size(array)) = array
    call move_alloc(longer, array)
  end subroutine grow
end module feap_mesh
