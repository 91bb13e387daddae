module bext_json_reader
  !! BEXT as JSON (U-splines). Ids count from 0; curves, surfaces and solids.
  !!
  !!     nodes [[x,y,z,w]]
  !!     elements.element_block_info [{num_elems, num_nodes, num_coefficient_vectors, deg_s, deg_t,
  !!       deg_u}]                                  -1: there is no such direction
  !!     elements.element_blocks [{node_ids, coeff_vector_ids}]     in the order of the blocks
  !!     coefficients.dense_coefficient_vectors [{components}]
  !!
  !! Sparse vectors are refused. Other keys are passed over, but for the counts num_nodes, num_elems
  !! and num_coeff_vecs, which must be right.
  use kinds, only: wp
  use json_scanner, only: json_type
  use growing_arrays, only: make_room
  use extraction_mesh, only: extraction_mesh_type, problem_list, check_elements, whole_number
  use bext_draft, only: bext_draft_type, element_block, block_problem
  implicit none (type, external)
  private
  public :: read_bext_json

  type :: id_lists
    !! Lists of ids of all elements, one after another.
    integer :: n = 0                     !! lists
    integer, allocatable :: last(:)      !! entry of each list (n)
    integer, allocatable :: ids(:)       !! as in the file
  end type id_lists

  type :: json_draft
    type(element_block), allocatable :: blocks(:)
    type(id_lists) :: nodes, vectors
    integer, allocatable :: line(:)      !! of each element
    integer :: ne = 0
    integer :: num_nodes = -1, num_elems = -1, num_vectors = -1   !! as announced
    integer :: num_sparse = 0
    integer :: sparse_line = 0
    type(bext_draft_type) :: bext
  end type json_draft

contains

  subroutine read_bext_json(text, mesh, problems)
    character(*), intent(in) :: text                   !! the file
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    type(json_type) :: json
    type(json_draft) :: draft
    character(:), allocatable :: key
    integer :: count_before

    call mesh%start('BEXT JSON')
    call json%open(text)
    allocate (draft%blocks(0))
    call json%begin('{', 'the file')
    do while (json%more_items('}'))
      call json%read_key(key)
      if (json%failed) exit
      select case (key)
      case ('nodes');          call read_nodes(json, mesh)
      case ('num_nodes');      call json%read_whole(draft%num_nodes)
      case ('num_elems');      call json%read_whole(draft%num_elems)
      case ('num_coeff_vecs'); call json%read_whole(draft%num_vectors)
      case ('elements');       call read_elements(json, draft)
      case ('coefficients');   call read_coefficients(json, draft)
      case default;            call json%skip_value()
      end select
    end do
    call json%refuse_rest()
    if (json%failed) then
      call problems%add(json%line, json%fact, '')
    else if (draft%num_sparse > 0) then
      call problems%add(draft%sparse_line, 'sparse coefficient vectors are not supported', &
        'Export dense vectors')
    else
      count_before = problems%count
      call compare('nodes', draft%num_nodes, mesh%nn)
      call compare('elements', draft%num_elems, draft%ne)
      call compare('coefficient vectors', draft%num_vectors, draft%bext%nv)
      call distribute(draft, problems)
      if (problems%count == count_before) then
        call draft%bext%build(draft%blocks, 0, mesh, problems)
        if (mesh%elements%ne == 0 .and. problems%count == count_before) &
          call problems%add(0, 'the file has no elements', '')
      end if
    end if
    call mesh%finish()
    if (problems%count == 0) call check_elements(mesh, 0, problems)

  contains

    subroutine compare(what, announced, found)
      character(*), intent(in) :: what
      integer, intent(in) :: announced, found

      if (announced >= 0 .and. announced /= found) call problems%add(0, 'the file announces ' // &
        whole_number(announced) // ' ' // what // ' and has ' // whole_number(found), '')
    end subroutine compare
  end subroutine read_bext_json

  subroutine read_nodes(json, mesh)
    type(json_type), intent(inout) :: json
    type(extraction_mesh_type), intent(inout) :: mesh

    real(wp), allocatable :: x(:)
    integer :: n

    call json%begin('[', 'nodes')
    do while (json%more_items(']'))
      call read_reals(json, 'a node', x, n)
      if (json%failed) return
      if (n /= 4) then
        json%failed = .true.
        json%fact = 'a node with ' // whole_number(n) // ' numbers, expected x, y, z, w'
        return
      end if
      call mesh%add_node(x(1:3), x(4), json%line)
    end do
  end subroutine read_nodes

  subroutine read_reals(json, what, x, n)
    type(json_type), intent(inout) :: json
    character(*), intent(in) :: what
    real(wp), allocatable, intent(inout) :: x(:)       !! grows
    integer, intent(out) :: n                          !! numbers

    n = 0
    call json%begin('[', what)
    do while (json%more_items(']'))
      n = n + 1
      call make_room(x, n)
      call json%read_number(x(n))
    end do
  end subroutine read_reals

  subroutine read_ids(json, what, lists)
    type(json_type), intent(inout) :: json
    character(*), intent(in) :: what
    type(id_lists), intent(inout) :: lists

    integer :: n

    n = 0
    if (lists%n > 0) n = lists%last(lists%n)
    call json%begin('[', what)
    do while (json%more_items(']'))
      n = n + 1
      call make_room(lists%ids, n)
      call json%read_whole(lists%ids(n))
    end do
    lists%n = lists%n + 1
    call make_room(lists%last, lists%n)
    call make_room(lists%ids, n)
    lists%last(lists%n) = n
  end subroutine read_ids

  subroutine read_elements(json, draft)
    type(json_type), intent(inout) :: json
    type(json_draft), intent(inout) :: draft

    character(:), allocatable :: key

    call json%begin('{', 'elements')
    do while (json%more_items('}'))
      call json%read_key(key)
      if (json%failed) return
      select case (key)
      case ('element_block_info'); call read_blocks(json, draft)
      case ('element_blocks');     call read_connectivities(json, draft)
      case default;                call json%skip_value()
      end select
    end do
  end subroutine read_elements

  subroutine read_blocks(json, draft)
    type(json_type), intent(inout) :: json
    type(json_draft), intent(inout) :: draft

    type(element_block) :: block
    character(:), allocatable :: key

    call json%begin('[', 'element_block_info')
    do while (json%more_items(']'))
      block = element_block()
      call json%begin('{', 'an element block')
      block%line = json%line
      do while (json%more_items('}'))
        call json%read_key(key)
        if (json%failed) return
        select case (key)
        case ('num_elems');               call json%read_whole(block%elements)
        case ('num_nodes');               call json%read_whole(block%functions)
        case ('num_coefficient_vectors'); call json%read_whole(block%vectors)
        case ('deg_s');                   call json%read_whole(block%degree(1))
        case ('deg_t');                   call json%read_whole(block%degree(2))
        case ('deg_u');                   call json%read_whole(block%degree(3))
        case default;                     call json%skip_value()
        end select
      end do
      draft%blocks = [draft%blocks, block]
    end do
  end subroutine read_blocks

  subroutine read_connectivities(json, draft)
    type(json_type), intent(inout) :: json
    type(json_draft), intent(inout) :: draft

    character(:), allocatable :: key

    call json%begin('[', 'element_blocks')
    do while (json%more_items(']'))
      call json%begin('{', 'an element')
      if (json%failed) return
      draft%ne = draft%ne + 1
      call make_room(draft%line, draft%ne)
      draft%line(draft%ne) = json%line
      do while (json%more_items('}'))
        call json%read_key(key)
        if (json%failed) return
        select case (key)
        case ('node_ids');         call read_ids(json, key, draft%nodes)
        case ('coeff_vector_ids'); call read_ids(json, key, draft%vectors)
        case default;              call json%skip_value()
        end select
      end do
      if (json%failed) return
      if (draft%nodes%n == draft%ne .and. draft%vectors%n == draft%ne) cycle
      json%failed = .true.
      json%fact = 'an element needs node_ids and coeff_vector_ids, once each'
    end do
  end subroutine read_connectivities

  subroutine read_coefficients(json, draft)
    type(json_type), intent(inout) :: json
    type(json_draft), intent(inout) :: draft

    character(:), allocatable :: key
    integer :: n

    call json%begin('{', 'coefficients')
    do while (json%more_items('}'))
      call json%read_key(key)
      if (json%failed) return
      select case (key)
      case ('num_sparse_coeff_blocks')
        call json%read_whole(n)
        if (n > 0) call found_sparse()
      case ('sparse_coefficient_vectors')
        call json%begin('[', key)
        do while (json%more_items(']'))
          call found_sparse()
          call json%skip_value()
        end do
      case ('dense_coefficient_vectors')
        call read_vectors(json, draft)
      case default
        call json%skip_value()
      end select
    end do

  contains

    subroutine found_sparse()
      if (draft%num_sparse == 0) draft%sparse_line = json%line
      draft%num_sparse = draft%num_sparse + 1
    end subroutine found_sparse
  end subroutine read_coefficients

  subroutine read_vectors(json, draft)
    type(json_type), intent(inout) :: json
    type(json_draft), intent(inout) :: draft

    character(:), allocatable :: key
    real(wp), allocatable :: x(:)
    integer :: n
    logical :: found

    allocate (x(0))
    call json%begin('[', 'dense_coefficient_vectors')
    do while (json%more_items(']'))
      found = .false.
      call json%begin('{', 'a coefficient vector')
      do while (json%more_items('}'))
        call json%read_key(key)
        if (json%failed) return
        if (key == 'components' .and. .not. found) then
          call read_reals(json, key, x, n)
          found = .true.
        else
          call json%skip_value()
        end if
      end do
      if (json%failed) return
      if (.not. found) then
        json%failed = .true.
        json%fact = 'a coefficient vector without components'
        return
      end if
      call draft%bext%add_vector(x(1:n))
    end do
  end subroutine read_vectors

  subroutine distribute(draft, problems)
    !! Elements belong to blocks in their order.
    type(json_draft), intent(inout) :: draft
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: fact
    integer :: e, i, k, n(2), first(2)

    e = 0
    first = 1
    do i = 1, size(draft%blocks)
      associate (block => draft%blocks(i))
        fact = block_problem(block)
        if (len(fact) > 0) then
          call problems%add(block%line, 'element block ' // whole_number(i - 1) // ': ' // fact, '')
          return
        end if
        do k = 1, block%elements
          if (e == draft%ne) exit
          e = e + 1
          n = [draft%nodes%last(e), draft%vectors%last(e)]
          if (any(n - first + 1 /= block%functions)) then
            call problems%add(draft%line(e), 'element ' // whole_number(e - 1) // ' has ' // &
              whole_number(n(1) - first(1) + 1) // ' node ids and ' // &
              whole_number(n(2) - first(2) + 1) // ' coefficient vector ids', &
              'Its block announces ' // whole_number(block%functions))
          else
            call draft%bext%add_element(i, draft%nodes%ids(first(1):n(1)) + 1, &
              draft%vectors%ids(first(2):n(2)) + 1, draft%line(e))
          end if
          first = n + 1
        end do
        if (k <= block%elements) exit
      end associate
    end do
    if (i <= size(draft%blocks)) then
      call problems%add(draft%blocks(i)%line, 'element block ' // whole_number(i - 1) // &
        ' announces more elements than there are', 'The file has ' // whole_number(draft%ne))
    else if (e < draft%ne) then
      call problems%add(draft%line(e+1), 'element ' // whole_number(e) // &
        ' belongs to no element block', 'The blocks announce ' // whole_number(e) // ' elements')
    end if
  end subroutine distribute
end module bext_json_reader
