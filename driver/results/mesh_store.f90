module mesh_store
  !! A mesh of extraction elements as an HDF5 file, the project's own form: small, exact, quick to
  !! read, and without the limits of text formats (curves, mixed dimensions, any name).
  !!
  !! In Python's order, nodes and elements from 1:
  !!
  !!     /                        attribute format = "bezel mesh", version = 1
  !!     /nodes (nn,4)            x, y, z, weight
  !!     /dimension (ne)          parametric dimension of each element
  !!     /degree (ne,3)           0 in unused directions
  !!     /connectivity_end (ne)   element e has connectivity[connectivity_end[e-1]:connectivity_end[e]]
  !!     /connectivity
  !!     /operator (ne)           operator of each element
  !!     /operator_rows, /operator_columns (nop)
  !!     /coefficients            of one operator after another; the function counts first
  !!     /sets/1, /sets/2, ...    each with name, kind (1 nodes, 2 elements, 3 sides), items, sides
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp, i8
  use status_codes, only: ok, status_text
  use hdf5_store, only: hdf5_store_type
  use extraction_mesh, only: extraction_mesh_type, problem_list, check_elements, check_sets, &
    whole_number, set_of_nodes, set_of_sides, largest_degree
  implicit none (type, external)
  private
  public :: write_mesh_store, read_mesh_store, is_mesh_store

  character(*), parameter :: format_name = 'bezel mesh'
  integer(i8), parameter :: format_version = 1

contains

  function is_mesh_store(path) result(answer)
    !! The file begins as HDF5 files do.
    character(*), intent(in) :: path
    logical :: answer
    character(8) :: start
    character(*), parameter :: signature = char(137)//'HDF'//char(13)//char(10)//char(26)//char(10)
    integer :: code, unit

    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=code)
    answer = code == 0
    if (.not. answer) return
    read (unit, iostat=code) start
    if (code /= 0) start = ''
    answer = start == signature
    close (unit, iostat=code)
  end function is_mesh_store

  subroutine write_mesh_store(path, mesh, message)
    character(*), intent(in) :: path
    type(extraction_mesh_type), intent(in) :: mesh
    character(:), allocatable, intent(out) :: message  !! allocated if it failed
    type(hdf5_store_type) :: store
    real(wp), allocatable :: nodes(:, :)
    character(:), allocatable :: group
    integer, allocatable :: names(:)
    integer :: i, k

    allocate (nodes(4, mesh%nn))
    nodes(1:3, :) = mesh%x(:, 1:mesh%nn)
    nodes(4, :) = mesh%w(1:mesh%nn)
    call store%create_draft(path)
    call store%write_attribute('/', 'format', format_name)
    call store%write_attribute('/', 'version', format_version)
    call store%write('/nodes', nodes)
    associate (set => mesh%elements, ne => mesh%elements%ne, nop => mesh%elements%nop)
      call store%write('/dimension', set%dp(1:ne))
      call store%write('/degree', set%degree(:, 1:ne))
      call store%write('/connectivity_end', set%node_ptr(2:ne + 1) - 1)
      call store%write('/connectivity', set%nodes(1:set%node_ptr(ne + 1) - 1))
      call store%write('/operator', set%operator_of(1:ne))
      call store%write('/operator_rows', set%op_rows(1:nop))
      call store%write('/operator_columns', set%op_columns(1:nop))
      call store%write('/coefficients', set%coef(1:set%op_ptr(nop + 1) - 1))
    end associate
    call store%make_group('/sets')
    do i = 1, size(mesh%sets)
      group = '/sets/'//whole_number(i)
      call store%make_group(group)
      names = [(iachar(mesh%sets(i)%name(k:k)), k=1, len(mesh%sets(i)%name))]
      call store%write(group//'/name', names)
      call store%write_attribute(group, 'kind', int(mesh%sets(i)%kind, i8))
      call store%write(group//'/items', mesh%sets(i)%items)
      call store%write(group//'/sides', mesh%sets(i)%sides)
    end do
    call store%publish()
    if (store%failed) message = store%message
  end subroutine write_mesh_store

  subroutine read_mesh_store(path, mesh, problems)
    !! Everything is checked: what the file holds fits together, or there are problems.
    character(*), intent(in) :: path
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems
    type(hdf5_store_type) :: store
    character(:), allocatable :: found
    integer(i8) :: version
    integer :: before

    call mesh%start('bezel HDF5')
    before = problems%count
    call store%open_to_read(path)
    call store%read_attribute('/', 'format', found)
    if (.not. store%failed) then
      if (found /= format_name) store%failed = .true.
    end if
    if (store%failed) then
      call problems%add(0, 'this HDF5 file is no mesh of bezel', 'EXPOrt writes one')
      call store%close()
      return
    end if
    call store%read_attribute('/', 'version', version)
    if (.not. store%failed .and. version /= format_version) call problems%add(0, &
      'the mesh has version '//whole_number(int(version))//', only version 1 is known', '')
    if (problems%count == before) call read_nodes(store, mesh, problems)
    if (problems%count == before .and. .not. store%failed) call read_elements(store, mesh, problems)
    if (problems%count == before .and. .not. store%failed) call read_sets(store, mesh, problems)
    if (store%failed) call problems%add(0, store%message, '')
    call store%close()
    call mesh%finish()
    if (problems%count == before) call check_elements(mesh, 1, problems)
    if (problems%count == before) call check_sets(mesh, 1, problems)
  end subroutine read_mesh_store

  subroutine read_nodes(store, mesh, problems)
    type(hdf5_store_type), intent(inout) :: store
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems
    real(wp), allocatable :: nodes(:, :)
    integer :: a

    call store%read('/nodes', nodes)
    if (store%failed) return
    if (size(nodes, 1) /= 4) then
      call problems%add(0, 'a node has '//whole_number(size(nodes, 1))//' numbers', 'They are x, y, z, weight')
    else if (.not. all(ieee_is_finite(nodes))) then
      call problems%add(0, 'a coordinate or a weight is not a finite number', '')
    else
      do a = 1, size(nodes, 2)
        call mesh%add_node(nodes(1:3, a), nodes(4, a), 0)
      end do
    end if
  end subroutine read_nodes

  subroutine read_elements(store, mesh, problems)
    type(hdf5_store_type), intent(inout) :: store
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems
    integer, allocatable :: dp(:), degree(:, :), last(:), nodes(:), op(:), rows(:), columns(:)
    real(wp), allocatable :: coef(:)
    integer(i8), allocatable :: begin(:)
    integer :: e, first, n, status

    call store%read('/dimension', dp)
    call store%read('/degree', degree)
    call store%read('/connectivity_end', last)
    call store%read('/connectivity', nodes)
    call store%read('/operator', op)
    call store%read('/operator_rows', rows)
    call store%read('/operator_columns', columns)
    call store%read('/coefficients', coef)
    if (store%failed) return
    n = size(dp)
    if (n == 0) then
      call problems%add(0, 'the mesh has no elements', '')
      return
    end if
    if (size(degree, 1) /= 3 .or. any([size(degree, 2), size(last), size(op)] /= n) .or. &
        size(rows) /= size(columns)) then
      call problems%add(0, 'arrays of the elements differ in length', '')
      return
    end if
    if (any(dp < 1 .or. dp > 3) .or. any(degree < 0 .or. degree > largest_degree) .or. &
        any(op < 1 .or. op > size(rows)) .or. any(rows < 1) .or. any(columns < 1)) then
      call problems%add(0, 'a dimension, a degree or an operator is out of range', '')
      return
    end if
    allocate (begin(size(rows) + 1))
    begin(1) = 0
    do e = 1, size(rows)
      begin(e + 1) = begin(e) + int(rows(e), i8)*columns(e)
    end do
    if (begin(size(begin)) /= size(coef, kind=i8)) then
      call problems%add(0, 'the operators do not have as many coefficients as their sizes need', '')
      return
    end if
    first = 1
    do e = 1, n
      if (last(e) < first .or. last(e) > size(nodes)) then
        call problems%add(0, 'the connectivity of element '//whole_number(e)//' is out of range', '')
        return
      end if
      if (last(e) - first + 1 /= rows(op(e)) .or. any(degree(dp(e) + 1:, e) /= 0) .or. &
          any(degree(1:dp(e), e) < 1)) then
        call problems%add(0, 'operator, degrees and connectivity of element '//whole_number(e)//' do not fit', '')
        return
      end if
      call mesh%add_element(degree(1:dp(e), e), nodes(first:last(e)), &
        reshape(coef(begin(op(e)) + 1:begin(op(e) + 1)), [rows(op(e)), columns(op(e))]), 0)
      first = last(e) + 1
    end do
    call mesh%elements%check(max(mesh%nn, maxval(nodes)), status, e)
    if (status /= ok) call problems%add(0, 'element '//whole_number(e)//': '//status_text(status), '')
  end subroutine read_elements

  subroutine read_sets(store, mesh, problems)
    type(hdf5_store_type), intent(inout) :: store
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems
    integer, allocatable :: letters(:), items(:), sides(:)
    character(:), allocatable :: group, name
    integer(i8) :: kind
    integer :: i, k

    i = 0
    do
      i = i + 1
      group = '/sets/'//whole_number(i)
      if (.not. store%has(group)) exit
      call store%read(group//'/name', letters)
      call store%read_attribute(group, 'kind', kind)
      call store%read(group//'/items', items)
      call store%read(group//'/sides', sides)
      if (store%failed) return
      if (kind < set_of_nodes .or. kind > set_of_sides .or. any(letters < 0 .or. letters > 255) .or. &
          size(sides) /= merge(size(items), 0, kind == set_of_sides)) then
        call problems%add(0, 'set '//whole_number(i)//' does not hold together', '')
        return
      end if
      allocate (character(size(letters)) :: name)
      do k = 1, size(letters)
        name(k:k) = achar(letters(k))
      end do
      call mesh%add_set(name, int(kind), 0, items, sides)
      deallocate (name)
    end do
  end subroutine read_sets
end module mesh_store
