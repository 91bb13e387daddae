module extraction_file
  !! Reads a file of extraction operators, whose format is found from its content.
  use kinds, only: wp, i8
  use extraction_mesh, only: extraction_mesh_type, problem_list
  use iga_reader, only: read_iga
  use bext_text_reader, only: read_bext_text
  use bext_json_reader, only: read_bext_json
  implicit none (type, external)
  private
  public :: read_extraction_file, read_extraction_text, text_format, load_text
  public :: unknown_format, format_iga, format_bext_text, format_bext_json

  integer, parameter :: unknown_format = 0, format_iga = 1, format_bext_text = 2, &
    format_bext_json = 3
  character(3), parameter :: byte_order_mark = char(239) // char(187) // char(191)

contains

  subroutine read_extraction_file(path, mesh, problems)
    character(*), intent(in) :: path
    type(extraction_mesh_type), intent(inout) :: mesh  !! complete if there are no problems
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: text
    logical :: found

    call load_text(path, text, found)
    if (found) then
      call read_extraction_text(text, mesh, problems)
    else
      call mesh%start('')
      call problems%add(0, 'the file cannot be read', '')
    end if
  end subroutine read_extraction_file

  subroutine read_extraction_text(text, mesh, problems)
    character(*), intent(in) :: text                   !! the file
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    integer :: first

    first = 1
    if (text(1:min(3, len(text))) == byte_order_mark) first = 4
    select case (text_format(text))
    case (format_iga);       call read_iga(text(first:), mesh, problems)
    case (format_bext_text); call read_bext_text(text(first:), mesh, problems)
    case (format_bext_json); call read_bext_json(text(first:), mesh, problems)
    case default
      call mesh%start('')
      call problems%add(0, 'this is no file of extraction operators', &
        'Known formats: .iga text, BEXT 2.0 text, BEXT JSON')
    end select
  end subroutine read_extraction_text

  pure integer function text_format(text)
    !! From the first word that is no comment.
    character(*), intent(in) :: text

    integer(i8) :: first, last, n

    text_format = unknown_format
    n = len(text, i8)
    first = 1
    if (text(1:min(3_i8, n)) == byte_order_mark) first = 4
    do while (first <= n)
      select case (text(first:first))
      case (' ', ',', achar(9), achar(10), achar(13))
        first = first + 1
        cycle
      case ('#', '$')
        do while (first <= n)
          if (text(first:first) == achar(10)) exit
          first = first + 1
        end do
        cycle
      end select
      exit
    end do
    if (first > n) return
    last = first
    do while (last < n)
      if (scan(text(last+1:last+1), ' ,' // achar(9) // achar(10) // achar(13)) > 0) exit
      last = last + 1
    end do
    select case (text(first:last))
    case ('type', 'nodeN', 'elemN', 'node', 'belem')
      text_format = format_iga
    case ('B')
      if (index(squeezed(text(first:min(first+40, n))), 'BEXT') == 1) &
        text_format = format_bext_text
    case default
      if (text(first:first) == '{') text_format = format_bext_json
    end select
  end function text_format

  pure function squeezed(text) result(short)
    !! Without blanks.
    character(*), intent(in) :: text
    character(:), allocatable :: short

    integer :: i

    short = ''
    do i = 1, len(text)
      if (text(i:i) /= ' ' .and. text(i:i) /= achar(9)) short = short // text(i:i)
    end do
  end function squeezed

  subroutine load_text(path, text, good)
    !! A whole file, byte by byte.
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: good

    integer(i8) :: length
    integer :: code, unit

    text = ''
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', &
      status='old', iostat=code)
    good = code == 0
    if (.not. good) return
    inquire (unit=unit, size=length)
    deallocate (text)
    allocate (character(max(length, 0_i8)) :: text)
    if (length > 0) read (unit, iostat=code) text
    good = code == 0 .and. length >= 0
    close (unit, iostat=code)
  end subroutine load_text
end module extraction_file
