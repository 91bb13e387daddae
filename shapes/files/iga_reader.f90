module iga_reader
  !! Text `.iga` of the T-splines plug-in for Rhino.
  !!
  !!     type plane | surface | thickened_surface | volume
  !!     nodeN n
  !!     elemN m
  !!     node x y z w                     n times, Cartesian; ids from 0
  !!     belem nen p q [r]                m times, then nen ids and nen rows of coefficients
  !!     set N node | side | elem NAME    then N ids, or N pairs of element and side
  !!     domain ...                       passed over
  !!
  !! Sides: LEFT s=0, RIGHT s=1, BOTTOM t=0, TOP t=1. For volumes nothing is documented: they keep
  !! these names, and BACK is u=0, FRONT is u=1; other words are refused.
  use kinds, only: wp, i8
  use text_scanner, only: scanner_type, list_type, list_done, list_ended, list_short, list_long, &
    list_bad_item, as_whole
  use extraction_mesh, only: extraction_mesh_type, problem_list, set_of_nodes, set_of_elements, &
    set_of_sides, largest_degree, check_elements, check_sets, whole_number, printable
  implicit none (type, external)
  private
  public :: read_iga, side_words

  !> of sides 1 to 6
  character(6), parameter :: side_words(6) = [character(6) :: 'LEFT', 'RIGHT', 'BOTTOM', 'TOP', &
    'BACK', 'FRONT']
  character(4), parameter :: set_words(3) = ['node', 'elem', 'side']
  integer, parameter :: set_kinds(3) = [set_of_nodes, set_of_elements, set_of_sides]
  character(*), parameter :: known_keywords = &
    'Known keywords: type, nodeN, elemN, node, belem, set, domain'

  type :: counts_type
    !! What the file announces, and where; -1: not yet.
    integer :: nodes = -1, nodes_line = 0
    integer :: elements = -1, elements_line = 0
    integer :: lost_nodes = 0, lost_elements = 0   !! with problems of their own
    integer :: least = 1, most = 3                 !! parametric directions
    character(:), allocatable :: kind              !! of the file, as written
  end type counts_type

contains

  subroutine read_iga(text, mesh, problems)
    character(*), intent(in) :: text                   !! the file
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    type(scanner_type) :: scanner
    type(counts_type) :: counts
    character(:), allocatable :: word
    logical :: found

    call mesh%start('.iga text')
    call scanner%open(text, '#')
    counts%kind = ''
    do
      call scanner%next_line(found)
      if (.not. found) exit
      call scanner%next_word(word)
      select case (word)
      case ('type');   call read_type(scanner, counts, problems)
      case ('nodeN');  call read_count(scanner, word, counts%nodes, counts%nodes_line, problems)
      case ('elemN')
        call read_count(scanner, word, counts%elements, counts%elements_line, problems)
      case ('node');   call read_node(scanner, counts, mesh, problems)
      case ('belem');  call read_element(scanner, counts, mesh, problems)
      case ('set');    call read_set(scanner, mesh, problems)
      case ('domain'); call skip_to_keyword(scanner)
      case default
        call problems%add(scanner%line, 'expected a keyword, found "' // printable(word) // '"', &
          known_keywords)
        call skip_to_keyword(scanner)
      end select
    end do
    call mesh%finish()
    call compare_counts(counts, mesh, problems)
    if (counts%lost_nodes == 0) call check_elements(mesh, 0, problems)
    if (counts%lost_nodes == 0 .and. counts%lost_elements == 0) &
      call check_sets(mesh, 0, problems)
  end subroutine read_iga

  subroutine read_type(scanner, counts, problems)
    type(scanner_type), intent(inout) :: scanner
    type(counts_type), intent(inout) :: counts
    type(problem_list), intent(inout) :: problems

    call scanner%next_word(counts%kind)
    select case (counts%kind)
    case ('plane', 'surface')
      counts%least = 2
      counts%most = 2
    case ('volume')
      counts%least = 3
    case ('thickened_surface')
      counts%least = 2
    case default
      call problems%add(scanner%line, 'unknown type "' // printable(counts%kind) // '"', &
        'Known types: plane, surface, thickened_surface, volume')
    end select
  end subroutine read_type

  subroutine read_count(scanner, keyword, n, line, problems)
    type(scanner_type), intent(inout) :: scanner
    character(*), intent(in) :: keyword
    integer, intent(inout) :: n, line
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: word
    real(wp) :: x(1)
    integer :: found
    logical :: good

    if (n >= 0) call problems%add(scanner%line, keyword // ' is given twice', 'See line ' // &
      whole_number(line))
    line = scanner%line
    call scanner%read_rest(x, found, word)
    call as_whole(x(1), n, good)
    good = good .and. n >= 0 .and. found == 1 .and. len(word) == 0
    if (good) return
    n = max(n, 0)
    call problems%add(line, keyword // ' needs one whole number that is not negative', '')
  end subroutine read_count

  subroutine read_node(scanner, counts, mesh, problems)
    type(scanner_type), intent(inout) :: scanner
    type(counts_type), intent(inout) :: counts
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: word
    real(wp) :: x(4)
    integer :: n

    call scanner%read_rest(x, n, word)
    if (len(word) > 0) then
      call problems%add(scanner%line, '"' // printable(word) // '" is not a finite number', &
        'A node is x y z w')
    else if (n /= 4) then
      call problems%add(scanner%line, 'a node with ' // whole_number(n) // ' numbers', &
        'A node is x y z w')
    else
      call mesh%add_node(x(1:3), x(4), scanner%line)
      return
    end if
    counts%lost_nodes = counts%lost_nodes + 1
  end subroutine read_node

  subroutine read_element(scanner, counts, mesh, problems)
    !! A faulty element is passed over to the next keyword.
    type(scanner_type), intent(inout) :: scanner
    type(counts_type), intent(inout) :: counts
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: word, name
    real(wp), allocatable :: ids(:), row(:), ce(:,:)
    integer, allocatable :: nodes(:)
    logical, allocatable :: good(:)
    type(list_type) :: list
    real(wp) :: header(4), nb
    integer :: whole(4), dp, n, line, a

    line = scanner%line
    name = 'element ' // whole_number(mesh%elements%ne + counts%lost_elements)
    counts%lost_elements = counts%lost_elements + 1      ! until it is there
    call scanner%read_rest(header, n, word)
    allocate (good(4))
    call as_whole(header, whole, good)
    dp = n - 1
    if (len(word) > 0) then
      call problems%add(line, name // ': "' // printable(word) // '" is not a finite number', &
        'An element begins with belem nen p q [r]')
    else if (dp < counts%least .or. dp > counts%most) then
      call problems%add(line, name // ' has ' // whole_number(max(dp, 0)) // ' degrees', &
        'Elements of type ' // counts%kind // ' begin with belem nen p q' // &
        trim(merge('    ', ' [r]', counts%most == 2)))
    else if (any(.not. good(1:n)) .or. any(whole(1:n) < 1) .or. &
      any(whole(2:n) > largest_degree)) then
      call problems%add(line, name // &
        ' needs whole numbers of functions (positive) and degrees (1 to ' // &
        whole_number(largest_degree) // ')', '')
    else
      nb = product(real(whole(2:n) + 1, wp))
      if (whole(1) * (nb + 1) > 0.5_wp * real(scanner%remaining() + 1, wp)) then
        call problems%add(line, name // ' announces more numbers than the file holds behind it', &
          'Correct the number of its functions or its degrees, or the file is truncated')
      else
        allocate (ids(whole(1)), nodes(whole(1)), row(nint(nb)), ce(whole(1),nint(nb)))
        call scanner%read_list(ids, list)
        call report_list(list, name // ': node ids', 'nodes', size(ids), problems)
        if (list%status == list_done) then
          deallocate (good)
          allocate (good(size(ids)))
          call as_whole(ids, nodes, good)
          if (.not. all(good)) then
            call problems%add(list%line, name // ': a node id is not a whole number', '')
          end if
          nodes = min(max(nodes, -2), huge(nodes) - 1) + 1
          do a = 1, size(nodes)
            call scanner%read_list(row, list)
            if (list%status /= list_done) exit
            ce(a,:) = row
          end do
          call report_list(list, name // ', row ' // whole_number(min(a, size(nodes))) // &
            ' of ' // whole_number(size(nodes)), 'coefficients', size(row), problems)
          if (list%status == list_done .and. all(good)) then
            call mesh%add_element(whole(2:n), nodes, ce, line)
            counts%lost_elements = counts%lost_elements - 1
            return
          end if
        end if
      end if
    end if
    call skip_to_keyword(scanner)
  end subroutine read_element

  subroutine report_list(list, what, items, n, problems)
    type(list_type), intent(in) :: list
    character(*), intent(in) :: what               !! 'element 3, row 2 of 16'
    character(*), intent(in) :: items              !! 'coefficients'
    integer, intent(in) :: n                       !! how many there should be
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: fact

    select case (list%status)
    case (list_done)
      return
    case (list_bad_item)
      call problems%add(list%line, what // ': "' // printable(list%word) // &
        '" is not a finite number', '')
      return
    case (list_ended)
      fact = ': the file ends after ' // whole_number(list%found)
    case (list_short)
      fact = ': a keyword follows after ' // whole_number(list%found)
    case default
      fact = ': found ' // whole_number(list%found)
    end select
    fact = what // fact // ' ' // items
    call problems%add(list%line, fact, 'Expected ' // whole_number(n))
  end subroutine report_list

  subroutine read_set(scanner, mesh, problems)
    type(scanner_type), intent(inout) :: scanner
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: count_word, kind_word, name, word
    integer, allocatable :: items(:), sides(:)
    integer :: kind, line, n, k
    logical :: good

    line = scanner%line
    call scanner%next_word(count_word)
    call scanner%next_word(kind_word)
    call scanner%next_word(name)
    kind = findloc(set_words == kind_word, .true., dim=1)
    call whole_word(count_word, n, good)
    if (.not. good .or. n < 0 .or. kind == 0 .or. len(name) == 0) then
      call problems%add(line, 'a set begins with: set N node NAME, set N side NAME, or ' // &
        'set N elem NAME', '')
      call skip_to_keyword(scanner)
      return
    end if
    kind = set_kinds(kind)
    if (real(n, wp) > 0.5_wp*real(scanner%remaining() + 1, wp)) then
      call problems%add(line, 'set "' // name // '" announces more items than the file holds', &
        'Correct their number, or the file is truncated')
      call skip_to_keyword(scanner)
      return
    end if
    allocate (items(n), sides(merge(n, 0, kind == set_of_sides)))
    do k = 1, n
      call next_item(word)
      if (len(word) == 0) exit
      call whole_word(word, items(k), good)
      if (.not. good) then
        call problems%add(scanner%line, 'set "' // name // '": "' // printable(word) // &
          '" is not the number of a node or an element', '')
        call skip_to_keyword(scanner)
        return
      end if
      items(k) = min(max(items(k), -2), huge(k) - 1) + 1
      if (kind /= set_of_sides) cycle
      call next_item(word)
      if (len(word) == 0) exit
      sides(k) = findloc(side_words == upper_case(word), .true., dim=1)
      if (sides(k) == 0) then
        call problems%add(scanner%line, 'set "' // name // '": there is no side "' // &
          printable(word) // '"', 'Sides are LEFT (s=0), RIGHT (s=1), BOTTOM (t=0), TOP (t=1)' // &
          ', and of volumes BACK (u=0), FRONT (u=1)')
        call skip_to_keyword(scanner)
        return
      end if
    end do
    if (k <= n) then
      call problems%add(line, 'set "' // name // '" announces ' // whole_number(n) // &
        ' items and has ' // whole_number(k - 1), '')
      return
    end if
    call scanner%next_word(word)
    if (len(word) > 0) then
      call problems%add(scanner%line, 'set "' // name // '" announces ' // whole_number(n) // &
        ' items and has more: "' // printable(word) // '"', '')
      return
    end if
    call mesh%add_set(name, kind, line, items, sides)

  contains

    subroutine next_item(word)
      !! On this line or the next; '' if a keyword or the end of the file comes first.
      character(:), allocatable, intent(out) :: word

      logical :: found

      call scanner%next_word(word)
      if (len(word) > 0) return
      call scanner%next_line(found)
      if (.not. found) return
      call scanner%next_word(word)
      if (.not. is_keyword(word)) return
      word = ''
      call scanner%back_to_line()
    end subroutine next_item
  end subroutine read_set

  subroutine whole_word(word, i, good)
    character(*), intent(in) :: word
    integer, intent(out) :: i
    logical, intent(out) :: good

    integer :: code

    i = 0
    good = len(word) > 0 .and. len(word) <= 10 .and. verify(word, '+-0123456789') == 0
    if (.not. good) return
    read (word, *, iostat=code) i
    good = code == 0
  end subroutine whole_word

  pure logical function is_keyword(word)
    character(*), intent(in) :: word

    select case (word)
    case ('type', 'nodeN', 'elemN', 'node', 'belem', 'set', 'domain')
      is_keyword = .true.
    case default
      is_keyword = .false.
    end select
  end function is_keyword

  subroutine skip_to_keyword(scanner)
    type(scanner_type), intent(inout) :: scanner

    character(:), allocatable :: word
    logical :: found

    do
      call scanner%next_line(found)
      if (.not. found) return
      call scanner%next_word(word)
      if (is_keyword(word)) exit
    end do
    call scanner%back_to_line()
  end subroutine skip_to_keyword

  subroutine compare_counts(counts, mesh, problems)
    type(counts_type), intent(in) :: counts
    type(extraction_mesh_type), intent(in) :: mesh
    type(problem_list), intent(inout) :: problems

    if (len(counts%kind) == 0) call problems%add(1, 'the file has no type', &
      'Write type plane, surface, thickened_surface or volume')
    call compare('nodeN', 'nodes', counts%nodes, counts%nodes_line, &
      mesh%nn + counts%lost_nodes)
    call compare('elemN', 'elements', counts%elements, counts%elements_line, &
      mesh%elements%ne + counts%lost_elements)
    if (mesh%elements%ne + counts%lost_elements == 0) &
      call problems%add(0, 'the file has no elements', '')

  contains

    subroutine compare(keyword, what, announced, line, found)
      character(*), intent(in) :: keyword, what
      integer, intent(in) :: announced, line, found

      if (announced < 0) then
        call problems%add(1, 'the file has no ' // keyword, 'Write the number of its ' // what)
      else if (announced /= found) then
        call problems%add(line, 'the file announces ' // whole_number(announced) // ' ' // what &
          // ' and has ' // whole_number(found), 'Correct the number, or the file is truncated')
      end if
    end subroutine compare
  end subroutine compare_counts

  pure function upper_case(word) result(upper)
    character(*), intent(in) :: word
    character(len(word)) :: upper

    integer :: i

    upper = word
    do i = 1, len(word)
      if (word(i:i) >= 'a' .and. word(i:i) <= 'z') upper(i:i) = achar(iachar(word(i:i)) - 32)
    end do
  end function upper_case
end module iga_reader
