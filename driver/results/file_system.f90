module file_system
  !! Calls of POSIX that Fortran lacks. Names are plain Fortran strings; .true. means done.
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_char, c_null_char
  use kinds, only: i8
  implicit none (type, external)
  private
  public :: make_folder, folder_exists, file_exists, file_size, remove_file, rename_file, cut_file, is_terminal, &
    system_error, read_text_file

  interface
    function c_mkdir(path, mode) bind(c, name='mkdir') result(code)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: code
    end function c_mkdir

    function c_remove(path) bind(c, name='remove') result(code)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: code
    end function c_remove

    function c_rename(from, to) bind(c, name='rename') result(code)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: from(*), to(*)
      integer(c_int) :: code
    end function c_rename

    function c_truncate(path, length) bind(c, name='truncate') result(code)
      import :: c_char, c_int, c_long
      character(kind=c_char), intent(in) :: path(*)
      integer(c_long), value :: length
      integer(c_int) :: code
    end function c_truncate

    function c_isatty(descriptor) bind(c, name='isatty') result(answer)
      import :: c_int
      integer(c_int), value :: descriptor
      integer(c_int) :: answer
    end function c_isatty

    subroutine bezel_error_text(text, length) bind(c)
      import :: c_char, c_int
      character(kind=c_char), intent(out) :: text(*)
      integer(c_int), value :: length
    end subroutine bezel_error_text

    subroutine bezel_clear_error() bind(c)
    end subroutine bezel_clear_error
  end interface

contains

  function make_folder(path) result(done)
    !! Make a folder and those above it.
    character(*), intent(in) :: path
    logical :: done
    integer :: i

    done = .true.
    do i = 1, len(path)
      if (path(i:i) /= '/' .and. i < len(path)) cycle
      if (folder_exists(path(:i))) cycle
      call bezel_clear_error()
      done = c_mkdir(path(:i)//c_null_char, int(o'777', c_int)) == 0
      if (.not. done) return
    end do
  end function make_folder

  function folder_exists(path) result(answer)
    character(*), intent(in) :: path
    logical :: answer

    inquire (file=path//'/.', exist=answer)
  end function folder_exists

  function file_exists(path) result(answer)
    !! Whether there is anything of this name, a folder too.
    character(*), intent(in) :: path
    logical :: answer

    inquire (file=path, exist=answer)
  end function file_exists

  function file_size(path) result(length)
    character(*), intent(in) :: path
    integer(i8) :: length  !! [byte], -1 if unknown

    inquire (file=path, size=length)
  end function file_size

  function remove_file(path) result(done)
    !! Remove a file, or a folder if it is empty.
    character(*), intent(in) :: path
    logical :: done

    call bezel_clear_error()
    done = c_remove(path//c_null_char) == 0
  end function remove_file

  function rename_file(from, to) result(done)
    !! Give a file a new name; a file that has it already is replaced in one instant.
    character(*), intent(in) :: from, to
    logical :: done

    call bezel_clear_error()
    done = c_rename(from//c_null_char, to//c_null_char) == 0
  end function rename_file

  function cut_file(path, length) result(done)
    !! Drop everything of a file beyond its first bytes.
    character(*), intent(in) :: path
    integer(i8), intent(in) :: length  !! what remains [byte]
    logical :: done

    call bezel_clear_error()
    done = c_truncate(path//c_null_char, int(length, c_long)) == 0
  end function cut_file

  function is_terminal(descriptor) result(answer)
    integer, intent(in) :: descriptor  !! 1: standard output, 2: standard error
    logical :: answer

    answer = c_isatty(int(descriptor, c_int)) == 1
  end function is_terminal

  function system_error() result(text)
    !! The system's words for the last failed call.
    character(:), allocatable :: text
    character(kind=c_char) :: buffer(200)
    integer :: i

    call bezel_error_text(buffer, int(size(buffer), c_int))
    text = ''
    do i = 1, size(buffer)
      if (buffer(i) == c_null_char) exit
      text = text//buffer(i)
    end do
  end function system_error

  subroutine read_text_file(path, text, failed)
    !! A whole file as one string, byte by byte as it stands.
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: failed
    integer(i8) :: length
    integer :: unit, code

    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=code)
    failed = code /= 0
    if (failed) then
      text = ''
      return
    end if
    inquire (unit=unit, size=length)
    allocate (character(max(length, 0_i8)) :: text)
    if (length > 0) read (unit, iostat=code) text
    failed = code /= 0 .or. length < 0
    close (unit, iostat=code)
  end subroutine read_text_file
end module file_system
