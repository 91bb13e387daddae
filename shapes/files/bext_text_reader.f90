module bext_text_reader
  !! BEXT 2.0 as text (`.bxt`, `.bext`; LS-DYNA's *IGA_INCLUDE_BEZIER). Ids count from 1.
  !!
  !!     B E X T 2.0
  !!     PID NN NE NCV WFL                          WFL = 1: the weights count
  !!     X Y Z W                                    NN lines, Cartesian
  !!     NEB
  !!     ETYPE NE NN NCV PR [PS [PT]]               NEB lines; ETYPE 1: full coefficient vectors
  !!     node ids; coefficient vector ids           per block, per element, two lists
  !!     NDCVB NSCVB
  !!     NCV NCOMP                                  NDCVB lines
  !!     components                                 of all vectors, ids run on through all blocks
  !!
  !! Refused: elements of type 0 (tensor products) and sparse vectors, whose layout is not known.
  !! Integers stand in fields of 8 characters, reals in fields of 24; fields that touch are told
  !! apart by these widths. Counts come before what they count, so that reading stops at the first
  !! list that is wrong.
  use kinds, only: wp
  use text_scanner, only: scanner_type, list_type, list_done, list_ended, list_bad_item, as_whole
  use extraction_mesh, only: extraction_mesh_type, problem_list, check_elements, whole_number, &
    printable
  use bext_draft, only: bext_draft_type, element_block, block_problem
  implicit none (type, external)
  private
  public :: read_bext_text

  integer, parameter :: integer_field = 8, real_field = 24

contains

  subroutine read_bext_text(text, mesh, problems)
    character(*), intent(in) :: text                   !! the file
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    type(scanner_type) :: scanner
    type(bext_draft_type) :: draft
    type(element_block), allocatable :: blocks(:)
    integer :: header(5), header_line
    logical :: good

    call mesh%start('BEXT 2.0 text')
    call scanner%open(text, '$')
    call read_version(scanner, problems, good)
    if (good) call read_integers(scanner, header, 'the line PID NN NE NCV WFL', header_line, &
      problems, good)
    if (good) call read_nodes(scanner, header(2), header(5), mesh, problems, good)
    if (good) call read_blocks(scanner, blocks, problems, good)
    if (good) call read_connectivities(scanner, blocks, draft, problems, good)
    if (good) call read_vectors(scanner, draft, problems, good)
    if (good) call refuse_rest(scanner, problems)
    if (good) then
      call compare('elements', header(3), draft%ne)
      call compare('coefficient vectors', header(4), draft%nv)
      call draft%build(blocks, 1, mesh, problems)
    end if
    call mesh%finish()
    if (good) call check_elements(mesh, 1, problems)

  contains

    subroutine compare(what, announced, found)
      character(*), intent(in) :: what
      integer, intent(in) :: announced, found

      if (announced /= found) call problems%add(header_line, 'the file announces ' // &
        whole_number(announced) // ' ' // what // ' and has ' // whole_number(found), '')
    end subroutine compare
  end subroutine read_bext_text

  subroutine read_version(scanner, problems, good)
    type(scanner_type), intent(inout) :: scanner
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    character(:), allocatable :: word
    integer :: i

    call scanner%next_line(good)
    do i = 1, 5
      if (good) call scanner%next_word(word)
    end do
    if (good) good = word(1:min(1, len(word))) == '2'
    if (.not. good) call problems%add(max(1, scanner%line), &
      'expected the line B E X T 2.0', 'Only version 2.0 is known')
  end subroutine read_version

  subroutine read_integers(scanner, values, what, line, problems, good)
    type(scanner_type), intent(inout) :: scanner
    integer, intent(out) :: values(:)
    character(*), intent(in) :: what
    integer, intent(out) :: line
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    real(wp) :: x(size(values))
    logical :: whole(size(values))
    type(list_type) :: list

    values = 0
    scanner%width = integer_field
    call scanner%read_list(x, list)
    line = list%line
    call report_list(list, what, size(values), problems, good)
    if (.not. good) return
    call as_whole(x, values, whole)
    good = all(whole)
    if (.not. good) call problems%add(list%line, what // ': a number is not whole', '')
  end subroutine read_integers

  subroutine report_list(list, what, n, problems, good)
    type(list_type), intent(in) :: list
    character(*), intent(in) :: what               !! 'the nodes of element 3'
    integer, intent(in) :: n                       !! numbers that it should have
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    character(:), allocatable :: fact

    good = list%status == list_done
    if (good) return
    select case (list%status)
    case (list_ended)
      fact = 'the file ends after ' // whole_number(list%found) // ' of ' // whole_number(n) // &
        ' numbers'
    case (list_bad_item)
      fact = '"' // printable(list%word) // '" is not a finite number'
    case default
      fact = 'expected ' // whole_number(n) // ' numbers, found ' // whole_number(list%found)
    end select
    call problems%add(list%line, what // ': ' // fact, '')
  end subroutine report_list

  subroutine read_nodes(scanner, nn, uses_weights, mesh, problems, good)
    type(scanner_type), intent(inout) :: scanner
    integer, intent(in) :: nn, uses_weights
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    type(list_type) :: list
    real(wp) :: x(4)
    integer :: a

    good = .true.
    scanner%width = real_field
    do a = 1, nn
      call scanner%read_list(x, list)
      call report_list(list, 'node ' // whole_number(a), 4, problems, good)
      if (.not. good) return
      if (uses_weights /= 1) x(4) = 1
      call mesh%add_node(x(1:3), x(4), list%line)
    end do
  end subroutine read_nodes

  subroutine read_blocks(scanner, blocks, problems, good)
    type(scanner_type), intent(inout) :: scanner
    type(element_block), allocatable, intent(out) :: blocks(:)
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    character(:), allocatable :: word, fact
    real(wp) :: x(7)
    integer :: i, line, n, numbers(7), one(1)
    logical :: whole(7)

    call read_integers(scanner, one, 'the number of element blocks', line, problems, good)
    if (.not. good) return
    good = one(1) >= 1 .and. one(1) <= scanner%remaining()
    if (.not. good) then
      call problems%add(line, 'the number of element blocks is ' // whole_number(one(1)), '')
      return
    end if
    allocate (blocks(one(1)))
    do i = 1, size(blocks)
      call scanner%next_line(good)
      if (.not. good) then
        call problems%add(scanner%line, 'the file ends before element block ' // whole_number(i), &
          '')
        return
      end if
      call scanner%read_rest(x, n, word)
      call as_whole(x, numbers, whole)
      associate (block => blocks(i))
        block%line = scanner%line
        block%elements = numbers(2)
        block%functions = numbers(3)
        block%vectors = numbers(4)
        if (n > 4) block%degree(1:min(n,7)-4) = numbers(5:min(n,7))
        if (len(word) > 0) then
          fact = '"' // printable(word) // '" is not a finite number'
        else if (n < 5 .or. n > 7 .or. .not. all(whole)) then
          fact = 'expected 5 to 7 whole numbers ETYPE NE NN NCV PR [PS [PT]]'
        else if (numbers(1) /= 1) then
          fact = 'elements of type ' // whole_number(numbers(1)) // &
            ' are not supported, only type 1 with full coefficient vectors'
        else
          fact = block_problem(block)
        end if
      end associate
      good = len(fact) == 0
      if (.not. good) then
        call problems%add(scanner%line, 'element block ' // whole_number(i) // ': ' // fact, '')
        return
      end if
    end do
  end subroutine read_blocks

  subroutine read_connectivities(scanner, blocks, draft, problems, good)
    type(scanner_type), intent(inout) :: scanner
    type(element_block), intent(in) :: blocks(:)
    type(bext_draft_type), intent(inout) :: draft
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    integer, allocatable :: nodes(:), vectors(:)
    character(:), allocatable :: name
    integer :: i, k, line, line_2

    good = .true.
    do i = 1, size(blocks)
      if (blocks(i)%functions > scanner%remaining()) then
        good = .false.
        call problems%add(blocks(i)%line, 'element block ' // whole_number(i) // &
          ' announces more numbers than the file holds behind it', &
          'Correct it, or the file is truncated')
        return
      end if
      allocate (nodes(blocks(i)%functions), vectors(blocks(i)%functions))
      do k = 1, blocks(i)%elements
        name = 'element ' // whole_number(draft%ne + 1)
        call read_integers(scanner, nodes, 'node ids of ' // name, line, problems, good)
        if (.not. good) return
        call read_integers(scanner, vectors, 'coefficient vector ids of ' // name, line_2, &
          problems, good)
        if (.not. good) return
        call draft%add_element(i, nodes, vectors, line)
      end do
      deallocate (nodes, vectors)
    end do
  end subroutine read_connectivities

  subroutine read_vectors(scanner, draft, problems, good)
    type(scanner_type), intent(inout) :: scanner
    type(bext_draft_type), intent(inout) :: draft
    type(problem_list), intent(inout) :: problems
    logical, intent(out) :: good

    integer :: numbers(2), i, k, line
    integer, allocatable :: blocks(:,:)
    real(wp), allocatable :: x(:)
    type(list_type) :: list

    call read_integers(scanner, numbers, 'the line NDCVB NSCVB', line, problems, good)
    if (.not. good) return
    if (numbers(2) /= 0) then
      good = .false.
      call problems%add(line, 'sparse coefficient vectors are not supported', &
        'Export dense vectors')
      return
    end if
    good = numbers(1) >= 0 .and. numbers(1) <= scanner%remaining()
    if (.not. good) then
      call problems%add(line, 'the number of blocks of vectors is ' // whole_number(numbers(1)), &
        '')
      return
    end if
    allocate (blocks(2,numbers(1)))
    do i = 1, size(blocks, 2)
      call read_integers(scanner, blocks(:,i), 'the line NCV NCOMP of block ' // whole_number(i), &
        line, problems, good)
      if (.not. good) return
      good = blocks(1,i) >= 0 .and. blocks(2,i) >= 1
      if (good) good = real(blocks(1,i), wp)*blocks(2,i) <= 0.5_wp*(scanner%remaining() + 1)
      if (.not. good) then
        call problems%add(line, 'block ' // whole_number(i) // ' of coefficient vectors ' // &
          'announces more numbers than the file holds behind it, or none', &
          'Correct it, or the file is truncated')
        return
      end if
    end do
    scanner%width = real_field
    do i = 1, size(blocks, 2)
      allocate (x(blocks(2,i)))
      do k = 1, blocks(1,i)
        call scanner%read_list(x, list)
        call report_list(list, 'coefficient vector ' // whole_number(draft%nv + 1), size(x), &
          problems, good)
        if (.not. good) return
        call draft%add_vector(x)
      end do
      deallocate (x)
    end do
  end subroutine read_vectors

  subroutine refuse_rest(scanner, problems)
    type(scanner_type), intent(inout) :: scanner
    type(problem_list), intent(inout) :: problems

    logical :: found

    call scanner%next_line(found)
    if (found) call problems%add(scanner%line, 'the file goes on after the last coefficient ' // &
      'vector', 'Correct its counts')
  end subroutine refuse_rest
end module bext_text_reader
