module byte_file
  !! A file that is written from front to back. It goes through the C library because gfortran's own writes report
  !! neither a full disk nor a failed flush. The first failure is kept, later calls do nothing, so that a caller may
  !! write a whole file and look once.
  use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char, c_ptr, c_null_ptr, c_null_char, c_associated, c_loc
  use kinds, only: wp, i8
  use file_system, only: rename_file, remove_file, system_error
  implicit none (type, external)
  private
  public :: byte_file_type

  type :: byte_file_type
    character(:), allocatable :: name        !! as the user knows it
    logical :: failed = .false.
    character(:), allocatable :: message     !! what failed, allocated if failed
    character(:), allocatable, private :: written_name
    type(c_ptr), private :: handle = c_null_ptr
  contains
    procedure :: create
    procedure :: create_draft
    procedure :: extend
    procedure :: is_open
    procedure :: put_text
    procedure :: put_line
    procedure, private :: put_real1, put_real2, put_int64, put_int8, put_any, begin, complain
    generic :: put => put_real1, put_real2, put_int64, put_int8
    procedure :: flush => flush_file
    procedure :: close => close_file
    procedure :: publish
  end type byte_file_type

  interface
    function c_fopen(path, mode) bind(c, name='fopen') result(handle)
      import :: c_char, c_ptr
      character(kind=c_char), intent(in) :: path(*), mode(*)
      type(c_ptr) :: handle
    end function c_fopen

    function c_fwrite(data, item, count, handle) bind(c, name='fwrite') result(written)
      import :: c_ptr, c_size_t
      type(c_ptr), value :: data
      integer(c_size_t), value :: item, count
      type(c_ptr), value :: handle
      integer(c_size_t) :: written
    end function c_fwrite

    function c_fflush(handle) bind(c, name='fflush') result(code)
      import :: c_ptr, c_int
      type(c_ptr), value :: handle
      integer(c_int) :: code
    end function c_fflush

    function c_fclose(handle) bind(c, name='fclose') result(code)
      import :: c_ptr, c_int
      type(c_ptr), value :: handle
      integer(c_int) :: code
    end function c_fclose
  end interface

contains

  subroutine create(self, name)
    !! Write a new file; one of this name is replaced.
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in) :: name

    call self%begin(name, name, 'wb')
  end subroutine create

  subroutine create_draft(self, name)
    !! Write NAME.tmp, which `publish` puts in the place of NAME in one instant.
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in) :: name

    call self%begin(name, name//'.tmp', 'wb')
  end subroutine create_draft

  subroutine extend(self, name)
    !! Go on at the end of a file.
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in) :: name

    call self%begin(name, name, 'ab')
  end subroutine extend

  subroutine begin(self, name, written_name, mode)
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in) :: name, written_name, mode

    if (self%is_open()) call self%close()
    self%failed = .false.
    if (allocated(self%message)) deallocate (self%message)
    self%name = name
    self%written_name = written_name
    self%handle = c_fopen(written_name//c_null_char, mode//c_null_char)
    if (.not. c_associated(self%handle)) call self%complain('open')
  end subroutine begin

  function is_open(self) result(answer)
    class(byte_file_type), intent(in) :: self
    logical :: answer

    answer = c_associated(self%handle)
  end function is_open

  subroutine put_text(self, text)
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in), target :: text

    if (len(text) > 0) call self%put_any(c_loc(text), 1_c_size_t, len(text, c_size_t))
  end subroutine put_text

  subroutine put_line(self, text)
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in) :: text

    call self%put_text(text//new_line('a'))
  end subroutine put_line

  subroutine put_real1(self, values)
    class(byte_file_type), intent(inout) :: self
    real(wp), intent(in), target, contiguous :: values(:)

    if (size(values) > 0) call self%put_any(c_loc(values), 8_c_size_t, size(values, kind=c_size_t))
  end subroutine put_real1

  subroutine put_real2(self, values)
    class(byte_file_type), intent(inout) :: self
    real(wp), intent(in), target, contiguous :: values(:, :)

    if (size(values) > 0) call self%put_any(c_loc(values), 8_c_size_t, size(values, kind=c_size_t))
  end subroutine put_real2

  subroutine put_int64(self, values)
    class(byte_file_type), intent(inout) :: self
    integer(i8), intent(in), target, contiguous :: values(:)

    if (size(values) > 0) call self%put_any(c_loc(values), 8_c_size_t, size(values, kind=c_size_t))
  end subroutine put_int64

  subroutine put_int8(self, values)
    use, intrinsic :: iso_fortran_env, only: int8
    class(byte_file_type), intent(inout) :: self
    integer(int8), intent(in), target, contiguous :: values(:)

    if (size(values) > 0) call self%put_any(c_loc(values), 1_c_size_t, size(values, kind=c_size_t))
  end subroutine put_int8

  subroutine put_any(self, data, item, count)
    class(byte_file_type), intent(inout) :: self
    type(c_ptr), intent(in) :: data
    integer(c_size_t), intent(in) :: item   !! [byte]
    integer(c_size_t), intent(in) :: count

    if (self%failed .or. .not. self%is_open()) return
    if (c_fwrite(data, item, count, self%handle) /= count) call self%complain('write')
  end subroutine put_any

  subroutine flush_file(self)
    !! Hand everything to the system: it survives the end of the program from here on.
    class(byte_file_type), intent(inout) :: self

    if (self%failed .or. .not. self%is_open()) return
    if (c_fflush(self%handle) /= 0) call self%complain('write')
  end subroutine flush_file

  subroutine close_file(self)
    class(byte_file_type), intent(inout) :: self
    integer(c_int) :: code

    if (.not. self%is_open()) return
    code = c_fclose(self%handle)
    self%handle = c_null_ptr
    if (code /= 0 .and. .not. self%failed) call self%complain('write')
  end subroutine close_file

  subroutine publish(self)
    !! Close a draft and give it its name; a draft that failed is removed and the older file stays.
    class(byte_file_type), intent(inout) :: self
    logical :: done

    call self%close()
    if (self%failed) then
      done = remove_file(self%written_name)
    else
      done = rename_file(self%written_name, self%name)
      if (.not. done) call self%complain('rename a file to')
    end if
  end subroutine publish

  subroutine complain(self, action)
    class(byte_file_type), intent(inout) :: self
    character(*), intent(in) :: action  !! what was tried

    self%failed = .true.
    self%message = 'cannot '//action//' '//self%name//': '//system_error()
  end subroutine complain
end module byte_file
