module input_file
  !! The part of Abaqus input files that the test host knows: *NODE, *USER ELEMENT, *ELEMENT, *NSET, *ELSET, *UEL PROPERTY,
  !! *BOUNDARY, *STEP, *STATIC, *END STEP, *INCLUDE; ** begins a comment.
  implicit none (type, external)
  private
  public :: model_type, set_type, step_type, boundary_type, user_element_type, read_input, set_called

  type :: set_type
    character(80) :: name = ''
    integer, allocatable :: items(:)
  end type set_type

  type :: user_element_type
    integer :: number = 0, type = 0, properties = 0, nsvars = 0
    integer, allocatable :: nodes(:)
    character(80) :: set = ''
    real(8), allocatable :: props(:)
  end type user_element_type

  type :: boundary_type
    character(80) :: set = ''
    integer :: first = 0, last = 0
    real(8) :: value = 0
  end type boundary_type

  type :: step_type
    real(8) :: increment = 1, period = 1
    type(boundary_type), allocatable :: boundaries(:)
  end type step_type

  type :: model_type
    integer :: ndm = 0
    real(8), allocatable :: x(:, :)
    type(user_element_type), allocatable :: elements(:)
    type(set_type), allocatable :: nsets(:), elsets(:)
    type(step_type), allocatable :: steps(:)
  end type model_type

  integer :: types(2, 1000) = 0          ! properties and variables of U1, U2, ... modulo 10000, by place
  integer :: type_number(1000) = 0, type_nodes(1000) = 0, ntypes = 0

contains

  recursive subroutine read_input(folder, name, model)
    character(*), intent(in) :: folder, name
    type(model_type), intent(inout) :: model
    character(2000) :: line
    character(80) :: key, at
    real(8) :: values(200)
    integer, allocatable :: list(:)
    integer :: code, i, n, unit, t

    if (.not. allocated(model%x)) then
      allocate (model%x(3, 0), model%elements(0), model%nsets(0), model%elsets(0), model%steps(1))
      allocate (model%steps(1)%boundaries(0))
      model%steps(1)%period = 0
    end if
    open (newunit=unit, file=folder//'/'//name, status='old', action='read', iostat=code)
    if (code /= 0) error stop 'host: an input file is missing'
    key = ''
    t = 0
    do
      read (unit, '(a)', iostat=code) line
      if (code /= 0) exit
      if (line(1:2) == '**' .or. line == '') cycle
      if (line(1:1) == '*') then
        at = line(2:)
        i = index(at, ',')
        if (i > 0) at(i:) = ''
        key = at
        select case (key)
        case ('INCLUDE')
          call read_input(folder, trim(option(line, 'INPUT')), model)
        case ('USER ELEMENT')
          ntypes = ntypes + 1
          type_number(ntypes) = whole(option(line, 'TYPE'), 2)
          type_nodes(ntypes) = whole(option(line, 'NODES'), 1)
          types(:, ntypes) = [whole(option(line, 'PROPERTIES'), 1), whole(option(line, 'VARIABLES'), 1)]
          model%ndm = whole(option(line, 'COORDINATES'), 1)
        case ('ELEMENT')
          t = findloc(type_number(1:ntypes), whole(option(line, 'TYPE'), 2), 1)
          if (t == 0) error stop 'host: an element of unknown type'
          at = option(line, 'ELSET')
        case ('NSET')
          at = option(line, 'NSET')
        case ('ELSET')
          at = option(line, 'ELSET')
        case ('UEL PROPERTY')
          at = option(line, 'ELSET')
        case ('STEP')
          call new_step(model%steps)
        end select
        cycle
      end if
      select case (key)
      case ('NODE')
        values = 0
        call numbers(line, values, n)
        if (nint(values(1)) /= size(model%x, 2) + 1) error stop 'host: nodes are numbered from 1'
        model%x = reshape([model%x, values(2:4)], [3, size(model%x, 2) + 1])
      case ('ELEMENT', 'NSET', 'ELSET')
        call whole_list(unit, line, list)
        if (key == 'ELEMENT') then
          if (size(list) /= type_nodes(t) + 1) error stop 'host: an element with the wrong number of nodes'
          call add_element(model%elements, list, type_number(t), types(1, t), types(2, t), at)
          call add_set(model%elsets, at, list(1:1))
        else if (key == 'NSET') then
          call add_set(model%nsets, at, list)
        else
          call add_set(model%elsets, at, list)
        end if
      case ('UEL PROPERTY')
        call numbers(line, values, n)
        i = set_called(model%elsets, at)
        do t = 1, size(model%elements)
          if (any(model%elsets(i)%items == model%elements(t)%number)) model%elements(t)%props = values(1:n)
        end do
      case ('STATIC')
        call numbers(line, values, n)
        model%steps(size(model%steps))%increment = values(1)
        model%steps(size(model%steps))%period = values(2)
      case ('BOUNDARY')
        i = index(line, ',')
        values = 0
        call numbers(line(i + 1:), values, n)
        if (n == 1) values(2) = values(1)
        associate (s => model%steps(size(model%steps)))
          s%boundaries = [s%boundaries, boundary_type(line(1:i - 1), nint(values(1)), nint(values(2)), values(3))]
        end associate
      end select
    end do
    close (unit)
  end subroutine read_input

  subroutine new_step(steps)
    type(step_type), allocatable, intent(inout) :: steps(:)
    type(step_type), allocatable :: longer(:)
    integer :: i

    allocate (longer(size(steps) + 1))
    do i = 1, size(steps)
      longer(i) = steps(i)
    end do
    allocate (longer(size(longer))%boundaries(0))
    call move_alloc(longer, steps)
  end subroutine new_step

  subroutine add_element(elements, list, type, properties, nsvars, set)
    type(user_element_type), allocatable, intent(inout) :: elements(:)
    integer, intent(in) :: list(:), type, properties, nsvars
    character(*), intent(in) :: set
    type(user_element_type), allocatable :: longer(:)
    integer :: n

    n = size(elements)
    allocate (longer(n + 1))
    longer(1:n) = elements
    longer(n + 1)%number = list(1)
    longer(n + 1)%nodes = list(2:)
    longer(n + 1)%type = type
    longer(n + 1)%properties = properties
    longer(n + 1)%nsvars = nsvars
    longer(n + 1)%set = set
    allocate (longer(n + 1)%props(0))
    call move_alloc(longer, elements)
  end subroutine add_element

  subroutine add_set(sets, name, items)
    type(set_type), allocatable, intent(inout) :: sets(:)
    character(*), intent(in) :: name
    integer, intent(in) :: items(:)
    type(set_type), allocatable :: longer(:)
    integer :: i, n

    n = size(sets)
    do i = 1, n
      if (sets(i)%name /= name) cycle
      sets(i)%items = [sets(i)%items, items]
      return
    end do
    allocate (longer(n + 1))
    longer(1:n) = sets
    longer(n + 1)%name = name
    longer(n + 1)%items = items
    call move_alloc(longer, sets)
  end subroutine add_set

  integer function set_called(sets, name) result(i)
    type(set_type), intent(in) :: sets(:)
    character(*), intent(in) :: name

    do i = 1, size(sets)
      if (sets(i)%name == name) return
    end do
    print '(2a)', 'host: there is no set ', trim(name)
    error stop
  end function set_called

  function option(line, name) result(value)
    character(*), intent(in) :: line, name
    character(80) :: value
    integer :: i, n

    value = ''
    i = index(line, ' '//name//'=')
    if (i == 0) return
    value = line(i + len(name) + 2:)
    n = index(value, ',')
    if (n > 0) value(n:) = ''
  end function option

  integer function whole(text, first)
    character(*), intent(in) :: text
    integer, intent(in) :: first
    integer :: code

    whole = 0
    read (text(first:), *, iostat=code) whole
  end function whole

  subroutine numbers(line, values, n)
    !! All numbers of a line.
    character(*), intent(in) :: line
    real(8), intent(inout) :: values(:)
    integer, intent(out) :: n
    integer :: code

    do n = 0, count([(line(code:code) == ',', code=1, len_trim(line))])
      read (line, *, iostat=code) values(1:n + 1)
      if (code /= 0) return
    end do
  end subroutine numbers

  subroutine whole_list(unit, line, list)
    !! Numbers of a line and of those after it, as long as a line ends with a comma.
    integer, intent(in) :: unit
    character(*), intent(inout) :: line
    integer, allocatable, intent(out) :: list(:)
    real(8) :: values(200)
    integer :: n, last

    allocate (list(0))
    do
      last = len_trim(line)
      call numbers(line, values, n)
      list = [list, nint(values(1:n))]
      if (line(last:last) /= ',') exit
      read (unit, '(a)') line
    end do
  end subroutine whole_list
end module input_file
