module vtu_writer
  !! ParaView's files of one instant: cells with fields, and interface points as vertices. Unstructured grids of
  !! version 2.2 (older versions swap two edges of hexahedra), arrays appended raw with 64-bit lengths. RationalWeights
  !! and HigherOrderDegrees are active attributes, without which viewers show polynomial geometry.
  !!
  !! A file of cells also carries its instant and the control values as field data, so that everything in the HDF5
  !! results can be recovered from it (`read_frame`).
  use, intrinsic :: iso_fortran_env, only: int8
  use kinds, only: wp, i8
  use byte_file, only: byte_file_type
  use file_system, only: read_text_file
  use shortest_text, only: real_text, integer_text
  use bezier_cells, only: bezier_cells_type
  use result_frame, only: result_field_type, result_frame_type
  implicit none (type, external)
  private
  public :: write_cells, write_vertices, read_frame, read_vtu_array

  character(*), parameter :: little_endian = 'LittleEndian', big_endian = 'BigEndian'

contains

  subroutine write_cells(path, cells, frame, message)
    character(*), intent(in) :: path
    type(bezier_cells_type), intent(in) :: cells
    type(result_frame_type), intent(in) :: frame
    character(:), allocatable, intent(out) :: message    !! what failed, unallocated when all is well

    type(byte_file_type) :: file
    character(:), allocatable :: text
    integer(i8) :: at
    integer :: k

    at = 0
    call begin_text(text, cells%np, cells%nc, 'TimeValue', 1, 1, at)
    call add_array(text, 'step', 'Float64', 1, 1, at, tuples=.true.)
    call add_array(text, 'control_values', 'Float64', size(frame%u, 1), size(frame%u, 2), at, tuples=.true.)
    call end_field_data(text, cells%np, cells%nc)
    call add_line(text, '<PointData RationalWeights="RationalWeights"'//active_names(frame%fields)//'>')
    call add_array(text, 'RationalWeights', 'Float64', 1, cells%np, at)
    do k = 1, size(frame%fields)
      call add_array(text, frame%fields(k)%name, 'Float64', size(frame%fields(k)%values, 1), cells%np, at)
    end do
    call add_line(text, '</PointData>')
    call add_line(text, '<CellData HigherOrderDegrees="HigherOrderDegrees">')
    call add_array(text, 'HigherOrderDegrees', 'Float64', 3, cells%nc, at)
    call add_array(text, 'material', 'Int64', 1, cells%nc, at)
    call add_array(text, 'body', 'Int64', 1, cells%nc, at)
    call add_line(text, '</CellData>')
    call add_geometry(text, cells%np, cells%nc, at)

    call file%create_draft(path)
    call file%put_text(text)
    call put_reals(file, 1, [frame%time])
    call put_reals(file, 1, [real(frame%step, wp)])
    call put_block(file, frame%u)
    call put_reals(file, size(cells%weights), cells%weights)
    do k = 1, size(frame%fields)
      call put_block(file, frame%fields(k)%values)
    end do
    call put_block(file, cells%degrees)
    call put_integers(file, int(cells%material, i8))
    call put_integers(file, int(cells%body, i8))
    call put_block(file, cells%points)
    call put_geometry(file, cells%connectivity, cells%offsets(2:), cells%types)
    call file%publish()
    if (file%failed) message = file%message
  end subroutine write_cells

  subroutine write_vertices(path, time, points, fields, message)
    !! Points without cells, such as the Gauss points of interfaces.
    character(*), intent(in) :: path
    real(wp), intent(in) :: time
    real(wp), contiguous, intent(in) :: points(:, :)       !! (3,np) [length]
    type(result_field_type), intent(in) :: fields(:)       !! values (components,np)
    character(:), allocatable, intent(out) :: message      !! what failed, unallocated when all is well

    integer(int8), parameter :: vertex = 1
    type(byte_file_type) :: file
    character(:), allocatable :: text
    integer(i8) :: at
    integer :: k, n

    n = size(points, 2)
    at = 0
    call begin_text(text, n, n, 'TimeValue', 1, 1, at)
    call end_field_data(text, n, n)
    call add_line(text, '<PointData>')
    do k = 1, size(fields)
      call add_array(text, fields(k)%name, 'Float64', size(fields(k)%values, 1), n, at)
    end do
    call add_line(text, '</PointData>')
    call add_geometry(text, n, n, at)

    call file%create_draft(path)
    call file%put_text(text)
    call put_reals(file, 1, [time])
    do k = 1, size(fields)
      call put_block(file, fields(k)%values)
    end do
    call put_block(file, points)
    call put_geometry(file, [(int(k, i8), k=0, n - 1)], [(int(k, i8), k=1, n)], [(vertex, k=1, n)])
    call file%publish()
    if (file%failed) message = file%message
  end subroutine write_vertices

  ! ---------------------------------------------------------------- the text in front

  subroutine begin_text(text, np, nc, name, components, tuples, at)
    character(:), allocatable, intent(out) :: text
    integer, intent(in) :: np, nc
    character(*), intent(in) :: name                   !! first array of the field data
    integer, intent(in) :: components, tuples
    integer(i8), intent(inout) :: at                   !! next free byte of the appended data

    if (np < 0 .or. nc < 0) error stop 'vtu_writer: a negative number of points'
    text = ''
    call add_line(text, '<?xml version="1.0"?>')
    call add_line(text, '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="'//byte_order()// &
      '" header_type="UInt64">')
    call add_line(text, '<UnstructuredGrid>')
    call add_line(text, '<FieldData>')
    call add_array(text, name, 'Float64', components, tuples, at, tuples=.true.)
  end subroutine begin_text

  subroutine end_field_data(text, np, nc)
    character(:), allocatable, intent(inout) :: text
    integer, intent(in) :: np, nc

    call add_line(text, '</FieldData>')
    call add_line(text, '<Piece NumberOfPoints="'//integer_text(np)//'" NumberOfCells="'//integer_text(nc)//'">')
  end subroutine end_field_data

  subroutine add_geometry(text, np, nc, at)
    character(:), allocatable, intent(inout) :: text
    integer, intent(in) :: np, nc
    integer(i8), intent(inout) :: at

    call add_line(text, '<Points>')
    call add_array(text, 'Points', 'Float64', 3, np, at)
    call add_line(text, '</Points>')
    call add_line(text, '<Cells>')
    call add_array(text, 'connectivity', 'Int64', 1, np, at)
    call add_array(text, 'offsets', 'Int64', 1, nc, at)
    call add_array(text, 'types', 'UInt8', 1, nc, at)
    call add_line(text, '</Cells>')
    call add_line(text, '</Piece>')
    call add_line(text, '</UnstructuredGrid>')
    call add_line(text, '<AppendedData encoding="raw">')
    text = text//'_'
  end subroutine add_geometry

  subroutine add_array(text, name, kind, components, count, at, tuples)
    character(:), allocatable, intent(inout) :: text
    character(*), intent(in) :: name, kind
    integer, intent(in) :: components, count
    integer(i8), intent(inout) :: at
    logical, intent(in), optional :: tuples      !! say the count (field data)

    character(:), allocatable :: count_text

    count_text = ''
    if (present(tuples)) count_text = ' NumberOfTuples="'//integer_text(count)//'"'
    call add_line(text, '<DataArray type="'//kind//'" Name="'//name//'" NumberOfComponents="'// &
      integer_text(components)//'"'//count_text//' format="appended" offset="'//integer_text(at)//'"/>')
    at = at + 8 + int(components, i8)*count*merge(1, 8, kind == 'UInt8')
  end subroutine add_array

  subroutine add_line(text, line)
    character(:), allocatable, intent(inout) :: text
    character(*), intent(in) :: line

    text = text//line//new_line('a')
  end subroutine add_line

  function active_names(fields) result(text)
    !! The first vector is what viewers warp by.
    type(result_field_type), intent(in) :: fields(:)
    character(:), allocatable :: text

    integer :: k

    text = ''
    do k = 1, size(fields)
      if (size(fields(k)%values, 1) /= 3) cycle
      text = ' Vectors="'//fields(k)%name//'"'
      return
    end do
  end function active_names

  pure function byte_order() result(text)
    character(:), allocatable :: text

    if (transfer([1_int8, 0_int8, 0_int8, 0_int8], 0) == 1) then
      text = little_endian
    else
      text = big_endian
    end if
  end function byte_order

  ! ---------------------------------------------------------------- the appended data

  subroutine put_reals(file, n, values)
    type(byte_file_type), intent(inout) :: file
    integer, intent(in) :: n
    real(wp), contiguous, intent(in) :: values(:)

    call file%put([8_i8*n])
    call file%put(values)
  end subroutine put_reals

  subroutine put_block(file, values)
    type(byte_file_type), intent(inout) :: file
    real(wp), contiguous, intent(in) :: values(:, :)

    call file%put([8_i8*size(values)])
    call file%put(values)
  end subroutine put_block

  subroutine put_integers(file, values)
    type(byte_file_type), intent(inout) :: file
    integer(i8), contiguous, intent(in) :: values(:)

    call file%put([8_i8*size(values)])
    call file%put(values)
  end subroutine put_integers

  subroutine put_geometry(file, connectivity, offsets, types)
    type(byte_file_type), intent(inout) :: file
    integer(i8), contiguous, intent(in) :: connectivity(:), offsets(:)
    integer(int8), contiguous, intent(in) :: types(:)

    call put_integers(file, connectivity)
    call put_integers(file, offsets)
    call file%put([int(size(types), i8)])
    call file%put(types)
    call file%put_text(new_line('a')//'</AppendedData>'//new_line('a')//'</VTKFile>'//new_line('a'))
  end subroutine put_geometry

  ! ---------------------------------------------------------------- reading back what this module wrote

  subroutine read_frame(path, frame, message)
    !! The instant, the control values and the fields of a file that `write_cells` wrote.
    character(*), intent(in) :: path
    type(result_frame_type), intent(out) :: frame
    character(:), allocatable, intent(out) :: message    !! what failed, unallocated when all is well

    character(:), allocatable :: text, name
    real(wp), allocatable :: values(:, :)
    type(result_field_type), allocatable :: longer(:)
    integer :: first, last, at, n
    logical :: failed

    call read_text_file(path, text, failed)
    if (failed) then
      message = 'cannot read '//path
      return
    end if
    call array_in_text(text, 'TimeValue', values, failed)
    if (.not. failed) frame%time = values(1, 1)
    if (.not. failed) call array_in_text(text, 'step', values, failed)
    if (.not. failed) frame%step = nint(values(1, 1))
    if (.not. failed) call array_in_text(text, 'control_values', frame%u, failed)
    allocate (frame%fields(0))
    first = index(text, '<PointData')
    last = index(text, '</PointData>')
    name = ''
    if (failed .or. first == 0 .or. last == 0) then
      message = path//' is not a whole result file of this program'
      return
    end if
    do
      at = index(text(first:last), ' Name="')
      if (at == 0) exit
      first = first + at + 6
      name = text(first:first+index(text(first:), '"')-2)
      if (name == 'RationalWeights') cycle
      n = size(frame%fields)
      allocate (longer(n+1))
      longer(:n) = frame%fields
      longer(n+1)%name = name
      call array_in_text(text, name, longer(n+1)%values, failed)
      call move_alloc(longer, frame%fields)
      if (failed) then
        message = path//' is not a whole result file of this program'
        return
      end if
    end do
  end subroutine read_frame

  subroutine read_vtu_array(path, name, values, failed)
    !! One array of reals or 64-bit integers of a file that this module wrote.
    character(*), intent(in) :: path, name
    real(wp), allocatable, intent(out) :: values(:, :)    !! (components,tuples)
    logical, intent(out) :: failed

    character(:), allocatable :: text

    call read_text_file(path, text, failed)
    if (.not. failed) call array_in_text(text, name, values, failed)
  end subroutine read_vtu_array

  subroutine array_in_text(text, name, values, failed)
    character(*), intent(in) :: text, name
    real(wp), allocatable, intent(out) :: values(:, :)
    logical, intent(out) :: failed

    character(*), parameter :: start_of_data = '<AppendedData encoding="raw">'//new_line('a')//'_'
    character(:), allocatable :: number
    integer :: at, from, last, components, code
    integer(i8) :: offset, length

    failed = .true.
    at = index(text, ' Name="'//name//'"')
    from = index(text, start_of_data)
    if (at == 0 .or. from == 0 .or. at > from) return
    last = at + index(text(at:), '/>')
    number = between(text(at:last), 'NumberOfComponents="')
    read (number, *, iostat=code) components
    if (code /= 0) return
    number = between(text(at:last), 'offset="')
    read (number, *, iostat=code) offset
    if (code /= 0) return
    from = from + len(start_of_data) + int(offset)
    if (from + 7 > len(text)) return
    length = transfer(text(from:from+7), length)
    if (components < 1 .or. length < 0 .or. from + 7 + length > len(text)) return
    from = from + 8
    allocate (values(components, length/8/components))
    last = index(text(:at), '<', back=.true.)
    if (between(text(last:at), 'type="') == 'Float64') then
      values = reshape(transfer(text(from:from+int(length)-1), 0.0_wp, size(values)), shape(values))
    else
      values = reshape(real(transfer(text(from:from+int(length)-1), 0_i8, size(values)), wp), shape(values))
    end if
    failed = .false.
  end subroutine array_in_text

  pure function between(text, opening) result(part)
    !! What stands between an opening and the next quotation mark.
    character(*), intent(in) :: text, opening
    character(:), allocatable :: part

    integer :: from, length

    part = ''
    from = index(text, opening)
    if (from == 0) return
    from = from + len(opening)
    length = index(text(from:), '"')
    if (length > 0) part = text(from:from+length-2)
  end function between
end module vtu_writer
