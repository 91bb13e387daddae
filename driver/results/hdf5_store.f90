module hdf5_store
  !! Arrays of reals and integers, texts and attributes by name in an HDF5 file, and series that grow along their last
  !! dimension: Fortran's types on top of module hdf5_file, with its way of keeping the first failure.
  !!
  !! Fortran's last dimension is the first one of HDF5: an array (3,np) here is (np,3) in Python.
  use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_null_char, c_loc
  use, intrinsic :: iso_fortran_env, only: int8
  use kinds, only: wp, i8
  use hdf5_binding, only: hid, bezel_h5_real64, bezel_h5_int32, bezel_h5_int64, bezel_h5_uint8, &
    bezel_h5_text, h5tclose
  use hdf5_file, only: hdf5_file_type, max_rank
  implicit none (type, external)
  private
  public :: hdf5_store_type

  type, extends(hdf5_file_type) :: hdf5_store_type
  contains
    procedure, private :: write_r1, write_r2, write_r3, write_i1, write_i2, write_l1, write_b1
    generic :: write => write_r1, write_r2, write_r3, write_i1, write_i2, write_l1, write_b1
    procedure, private :: append_r1, append_r2, append_r3, append_i1, append_i2, append_l1, append_l2, append_b1
    generic :: append => append_r1, append_r2, append_r3, append_i1, append_i2, append_l1, append_l2, append_b1
    procedure, private :: read_r1, read_r2, read_r3, read_i1, read_i2, read_l1
    generic :: read => read_r1, read_r2, read_r3, read_i1, read_i2, read_l1
    procedure :: write_text
    procedure :: read_text
    procedure, private :: attribute_text, attribute_l0, attribute_l1, attribute_r0
    generic :: write_attribute => attribute_text, attribute_l0, attribute_l1, attribute_r0
    procedure, private :: read_attribute_l0, read_attribute_r0, read_attribute_text
    generic :: read_attribute => read_attribute_l0, read_attribute_r0, read_attribute_text
  end type hdf5_store_type

contains

  ! ---------------------------------------------------------------- arrays

  subroutine write_r1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: values(:)

    call self%write_any(path, bezel_h5_real64(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_r1

  subroutine write_r2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: values(:, :)

    call self%write_any(path, bezel_h5_real64(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_r2

  subroutine write_r3(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: values(:, :, :)

    call self%write_any(path, bezel_h5_real64(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_r3

  subroutine write_i1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in), target, contiguous :: values(:)

    call self%write_any(path, bezel_h5_int32(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_i1

  subroutine write_i2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in), target, contiguous :: values(:, :)

    call self%write_any(path, bezel_h5_int32(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_i2

  subroutine write_l1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(i8), intent(in), target, contiguous :: values(:)

    call self%write_any(path, bezel_h5_int64(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_l1

  subroutine write_b1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(int8), intent(in), target, contiguous :: values(:)   !! unsigned in the file

    call self%write_any(path, bezel_h5_uint8(), shape(values, i8), c_loc(values), growing=.false.)
  end subroutine write_b1

  subroutine append_r1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: values(:)

    call self%append_any(path, bezel_h5_real64(), shape(values, i8), c_loc(values))
  end subroutine append_r1

  subroutine append_r2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: values(:, :)

    call self%append_any(path, bezel_h5_real64(), shape(values, i8), c_loc(values))
  end subroutine append_r2

  subroutine append_r3(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), intent(in), target, contiguous :: values(:, :, :)

    call self%append_any(path, bezel_h5_real64(), shape(values, i8), c_loc(values))
  end subroutine append_r3

  subroutine append_i1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in), target, contiguous :: values(:)

    call self%append_any(path, bezel_h5_int32(), shape(values, i8), c_loc(values))
  end subroutine append_i1

  subroutine append_i2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in), target, contiguous :: values(:, :)

    call self%append_any(path, bezel_h5_int32(), shape(values, i8), c_loc(values))
  end subroutine append_i2

  subroutine append_l1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(i8), intent(in), target, contiguous :: values(:)

    call self%append_any(path, bezel_h5_int64(), shape(values, i8), c_loc(values))
  end subroutine append_l1

  subroutine append_l2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(i8), intent(in), target, contiguous :: values(:, :)

    call self%append_any(path, bezel_h5_int64(), shape(values, i8), c_loc(values))
  end subroutine append_l2

  subroutine append_b1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(int8), intent(in), target, contiguous :: values(:)   !! unsigned in the file

    call self%append_any(path, bezel_h5_uint8(), shape(values, i8), c_loc(values))
  end subroutine append_b1

  subroutine read_r1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), allocatable, target, intent(out) :: values(:)

    integer(i8) :: n(max_rank)

    call self%find_shape(path, 1, n)
    allocate (values(n(1)))
    if (size(values) > 0) call self%read_any(path, bezel_h5_real64(), c_loc(values))
  end subroutine read_r1

  subroutine read_r2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), allocatable, target, intent(out) :: values(:, :)

    integer(i8) :: n(max_rank)

    call self%find_shape(path, 2, n)
    allocate (values(n(1), n(2)))
    if (size(values) > 0) call self%read_any(path, bezel_h5_real64(), c_loc(values))
  end subroutine read_r2

  subroutine read_r3(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    real(wp), allocatable, target, intent(out) :: values(:, :, :)

    integer(i8) :: n(max_rank)

    call self%find_shape(path, 3, n)
    allocate (values(n(1), n(2), n(3)))
    if (size(values) > 0) call self%read_any(path, bezel_h5_real64(), c_loc(values))
  end subroutine read_r3

  subroutine read_i1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, allocatable, target, intent(out) :: values(:)

    integer(i8) :: n(max_rank)

    call self%find_shape(path, 1, n)
    allocate (values(n(1)))
    if (size(values) > 0) call self%read_any(path, bezel_h5_int32(), c_loc(values))
  end subroutine read_i1

  subroutine read_i2(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, allocatable, target, intent(out) :: values(:, :)

    integer(i8) :: n(max_rank)

    call self%find_shape(path, 2, n)
    allocate (values(n(1), n(2)))
    if (size(values) > 0) call self%read_any(path, bezel_h5_int32(), c_loc(values))
  end subroutine read_i2

  subroutine read_l1(self, path, values)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(i8), allocatable, target, intent(out) :: values(:)

    integer(i8) :: n(max_rank)

    call self%find_shape(path, 1, n)
    allocate (values(n(1)))
    if (size(values) > 0) call self%read_any(path, bezel_h5_int64(), c_loc(values))
  end subroutine read_l1

  ! ---------------------------------------------------------------- texts

  subroutine write_text(self, path, text)
    !! A text of any length, lines separated by line feeds.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, text

    character(:), allocatable, target :: padded
    integer(hid) :: kind

    padded = text//c_null_char
    kind = bezel_h5_text(len(padded, c_size_t), 1_c_int)
    call self%write_any(path, kind, [1_i8], c_loc(padded), growing=.false.)
    call release(kind)
  end subroutine write_text

  subroutine read_text(self, path, text)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    character(:), allocatable, target, intent(out) :: text

    integer(hid) :: kind
    integer :: n

    n = self%text_length(path)
    text = repeat(' ', n)
    if (n == 0) then
      call self%complain(self%name//' has no text '//path)
      return
    end if
    kind = bezel_h5_text(int(n, c_size_t), 1_c_int)
    call self%read_any(path, kind, c_loc(text))
    call release(kind)
    text = before_null(text)
  end subroutine read_text

  pure function before_null(text) result(shorter)
    character(*), intent(in) :: text
    character(:), allocatable :: shorter

    integer :: n

    n = index(text, c_null_char)
    shorter = text
    if (n > 0) shorter = text(:n-1)
  end function before_null

  subroutine release(kind)
    !! Give back a type of text. A failure of that loses nothing.
    integer(hid), intent(in) :: kind   !! negative: there is none

    if (kind < 0) return
    if (h5tclose(kind) < 0) return
  end subroutine release

  ! ---------------------------------------------------------------- attributes

  subroutine attribute_text(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    character(*), intent(in), target :: value   !! not empty

    integer(hid) :: kind

    kind = bezel_h5_text(len(value, c_size_t), 0_c_int)
    call self%write_attribute_any(path, name, kind, 0, c_loc(value))
    call release(kind)
  end subroutine attribute_text

  subroutine attribute_l0(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer(i8), intent(in), target :: value

    call self%write_attribute_any(path, name, bezel_h5_int64(), 0, c_loc(value))
  end subroutine attribute_l0

  subroutine attribute_l1(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer(i8), intent(in), target, contiguous :: value(:)   !! not empty

    call self%write_attribute_any(path, name, bezel_h5_int64(), size(value), c_loc(value))
  end subroutine attribute_l1

  subroutine attribute_r0(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    real(wp), intent(in), target :: value

    call self%write_attribute_any(path, name, bezel_h5_real64(), 0, c_loc(value))
  end subroutine attribute_r0

  subroutine read_attribute_l0(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer(i8), intent(out), target :: value

    value = 0
    call self%read_attribute_any(path, name, bezel_h5_int64(), c_loc(value))
  end subroutine read_attribute_l0

  subroutine read_attribute_r0(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    real(wp), intent(out), target :: value

    value = 0
    call self%read_attribute_any(path, name, bezel_h5_real64(), c_loc(value))
  end subroutine read_attribute_r0

  subroutine read_attribute_text(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    character(:), allocatable, intent(out), target :: value

    integer(hid) :: kind
    integer :: n

    n = self%attribute_length(path, name)
    value = repeat(' ', n)
    if (n == 0) then
      call self%complain('cannot read the attribute '//name//' of '//path//' of '//self%name)
      return
    end if
    kind = bezel_h5_text(int(n, c_size_t), 0_c_int)
    call self%read_attribute_any(path, name, kind, c_loc(value))
    call release(kind)
    value = before_null(value)
  end subroutine read_attribute_text
end module hdf5_store
