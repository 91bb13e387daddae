module hdf5_store
  !! A small safe layer over the C interface of HDF5: arrays of reals and integers, texts and attributes by name, and
  !! series that grow along their last dimension. Nothing stops or prints: the first failure is kept with its message,
  !! later calls do nothing, so that a caller may write a whole file and look once.
  !!
  !! Fortran's last dimension is the first one of HDF5: an array (3,np) here is (np,3) in Python.
  use, intrinsic :: iso_c_binding, only: c_int, c_long, c_int64_t, c_size_t, c_char, c_ptr, c_null_ptr, &
    c_null_char, c_loc
  use, intrinsic :: iso_fortran_env, only: int8
  use kinds, only: wp, i8
  use file_system, only: rename_file, remove_file, file_exists, system_error
  implicit none (type, external)
  private
  public :: hdf5_store_type

  integer, parameter :: hid = c_int64_t
  integer, parameter :: max_rank = 3
  integer(hid), parameter :: default_list = 0, whole_space = 0
  integer(c_int), parameter :: read_only = 0, read_write = 1, truncate_old = 2   ! H5F_ACC_RDONLY, _RDWR, _TRUNC
  integer(c_int), parameter :: select_set = 0                                    ! H5S_SELECT_SET
  integer(c_int), parameter :: local_scope = 0                                   ! H5F_SCOPE_LOCAL
  integer(i8), parameter :: chunk_items = 32768                                  !! wanted items in a chunk of a series

  logical, save :: prepared = .false.    !! the library has been told what to leave out, once for the process

  type :: hdf5_store_type
    character(:), allocatable :: name      !! file, as the user knows it
    logical :: failed = .false.
    character(:), allocatable :: message   !! what failed, allocated if failed
    character(:), allocatable, private :: written_name
    integer(hid), private :: file = -1
  contains
    procedure :: create_draft
    procedure :: publish
    procedure :: open_to_read
    procedure :: open_to_write
    procedure :: close => close_file
    procedure :: is_open
    procedure :: has
    procedure :: length
    procedure :: set_length
    procedure, private :: write_r1, write_r2, write_r3, write_i1, write_i2, write_l1, write_b1
    generic :: write => write_r1, write_r2, write_r3, write_i1, write_i2, write_l1, write_b1
    procedure, private :: append_r1, append_r2, append_r3, append_i1, append_i2, append_l1, append_l2, append_b1
    generic :: append => append_r1, append_r2, append_r3, append_i1, append_i2, append_l1, append_l2, append_b1
    procedure, private :: read_r1, read_r2, read_r3, read_i1, read_i2, read_l1
    generic :: read => read_r1, read_r2, read_r3, read_i1, read_i2, read_l1
    procedure :: write_text
    procedure :: read_text
    procedure :: make_group
    procedure, private :: attribute_text, attribute_l0, attribute_l1, attribute_r0
    generic :: write_attribute => attribute_text, attribute_l0, attribute_l1, attribute_r0
    procedure, private :: read_attribute_l0, read_attribute_r0, read_attribute_text
    generic :: read_attribute => read_attribute_l0, read_attribute_r0, read_attribute_text
    procedure, private :: begin, complain, write_any, append_any, read_any, find_shape
    procedure, private :: attribute_any, read_attribute_any
  end type hdf5_store_type

  interface
    ! facts that exist only as macros of C headers (system_calls.c)
    function bezel_h5_real64() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_real64
    function bezel_h5_int32() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_int32
    function bezel_h5_int64() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_int64
    function bezel_h5_uint8() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_uint8
    function bezel_h5_text(length, utf8) bind(c) result(id)
      import :: hid, c_size_t, c_int
      integer(c_size_t), value :: length
      integer(c_int), value :: utf8
      integer(hid) :: id
    end function bezel_h5_text
    function bezel_h5_link_creation() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_link_creation
    function bezel_h5_dataset_creation() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_dataset_creation
    function bezel_h5_file_access() bind(c) result(id)
      import :: hid
      integer(hid) :: id
    end function bezel_h5_file_access
    function bezel_h5_silence() bind(c) result(code)
      import :: c_int
      integer(c_int) :: code
    end function bezel_h5_silence

    function h5dont_atexit() bind(c, name='H5dont_atexit') result(code)
      import :: c_int
      integer(c_int) :: code
    end function h5dont_atexit
    function h5open() bind(c, name='H5open') result(code)
      import :: c_int
      integer(c_int) :: code
    end function h5open
    function h5fcreate(name, flags, creation, access) bind(c, name='H5Fcreate') result(id)
      import :: hid, c_int, c_char
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), value :: flags
      integer(hid), value :: creation, access
      integer(hid) :: id
    end function h5fcreate
    function h5fopen(name, flags, access) bind(c, name='H5Fopen') result(id)
      import :: hid, c_int, c_char
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), value :: flags
      integer(hid), value :: access
      integer(hid) :: id
    end function h5fopen
    function h5fflush(object, scope) bind(c, name='H5Fflush') result(code)
      import :: hid, c_int
      integer(hid), value :: object
      integer(c_int), value :: scope
      integer(c_int) :: code
    end function h5fflush
    function h5fclose(id) bind(c, name='H5Fclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5fclose
    function h5pclose(id) bind(c, name='H5Pclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5pclose
    function h5pset_chunk(list, rank, dims) bind(c, name='H5Pset_chunk') result(code)
      import :: hid, c_int, c_int64_t
      integer(hid), value :: list
      integer(c_int), value :: rank
      integer(c_int64_t), intent(in) :: dims(*)
      integer(c_int) :: code
    end function h5pset_chunk
    function h5gcreate(location, name, links, creation, access) bind(c, name='H5Gcreate2') result(id)
      import :: hid, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: name(*)
      integer(hid), value :: links, creation, access
      integer(hid) :: id
    end function h5gcreate
    function h5gclose(id) bind(c, name='H5Gclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5gclose
    function h5lexists(location, name, access) bind(c, name='H5Lexists') result(answer)
      import :: hid, c_int, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: name(*)
      integer(hid), value :: access
      integer(c_int) :: answer
    end function h5lexists
    function h5screate_simple(rank, dims, maxdims) bind(c, name='H5Screate_simple') result(id)
      import :: hid, c_int, c_int64_t
      integer(c_int), value :: rank
      integer(c_int64_t), intent(in) :: dims(*), maxdims(*)
      integer(hid) :: id
    end function h5screate_simple
    function h5sclose(id) bind(c, name='H5Sclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5sclose
    function h5sselect_hyperslab(space, operation, start, stride, count, block) &
      bind(c, name='H5Sselect_hyperslab') result(code)
      import :: hid, c_int, c_int64_t, c_ptr
      integer(hid), value :: space
      integer(c_int), value :: operation
      integer(c_int64_t), intent(in) :: start(*), count(*)
      type(c_ptr), value :: stride, block
      integer(c_int) :: code
    end function h5sselect_hyperslab
    function h5sget_simple_extent_ndims(space) bind(c, name='H5Sget_simple_extent_ndims') result(rank)
      import :: hid, c_int
      integer(hid), value :: space
      integer(c_int) :: rank
    end function h5sget_simple_extent_ndims
    function h5sget_simple_extent_dims(space, dims, maxdims) bind(c, name='H5Sget_simple_extent_dims') result(rank)
      import :: hid, c_int, c_int64_t
      integer(hid), value :: space
      integer(c_int64_t), intent(out) :: dims(*), maxdims(*)
      integer(c_int) :: rank
    end function h5sget_simple_extent_dims
    function h5dcreate(location, name, kind, space, links, creation, access) bind(c, name='H5Dcreate2') result(id)
      import :: hid, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: name(*)
      integer(hid), value :: kind, space, links, creation, access
      integer(hid) :: id
    end function h5dcreate
    function h5dopen(location, name, access) bind(c, name='H5Dopen2') result(id)
      import :: hid, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: name(*)
      integer(hid), value :: access
      integer(hid) :: id
    end function h5dopen
    function h5dclose(id) bind(c, name='H5Dclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5dclose
    function h5dget_space(dataset) bind(c, name='H5Dget_space') result(id)
      import :: hid
      integer(hid), value :: dataset
      integer(hid) :: id
    end function h5dget_space
    function h5dget_type(dataset) bind(c, name='H5Dget_type') result(id)
      import :: hid
      integer(hid), value :: dataset
      integer(hid) :: id
    end function h5dget_type
    function h5dset_extent(dataset, dims) bind(c, name='H5Dset_extent') result(code)
      import :: hid, c_int, c_int64_t
      integer(hid), value :: dataset
      integer(c_int64_t), intent(in) :: dims(*)
      integer(c_int) :: code
    end function h5dset_extent
    function h5dwrite(dataset, memory_kind, memory, space, transfer, data) bind(c, name='H5Dwrite') result(code)
      import :: hid, c_int, c_ptr
      integer(hid), value :: dataset, memory_kind, memory, space, transfer
      type(c_ptr), value :: data
      integer(c_int) :: code
    end function h5dwrite
    function h5dread(dataset, memory_kind, memory, space, transfer, data) bind(c, name='H5Dread') result(code)
      import :: hid, c_int, c_ptr
      integer(hid), value :: dataset, memory_kind, memory, space, transfer
      type(c_ptr), value :: data
      integer(c_int) :: code
    end function h5dread
    function h5tget_size(kind) bind(c, name='H5Tget_size') result(length)
      import :: hid, c_size_t
      integer(hid), value :: kind
      integer(c_size_t) :: length
    end function h5tget_size
    function h5tclose(id) bind(c, name='H5Tclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5tclose
    function h5aexists(location, object, name, access) bind(c, name='H5Aexists_by_name') result(answer)
      import :: hid, c_int, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: object(*), name(*)
      integer(hid), value :: access
      integer(c_int) :: answer
    end function h5aexists
    function h5acreate(location, object, name, kind, space, creation, access, links) &
      bind(c, name='H5Acreate_by_name') result(id)
      import :: hid, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: object(*), name(*)
      integer(hid), value :: kind, space, creation, access, links
      integer(hid) :: id
    end function h5acreate
    function h5aopen(location, object, name, access, links) bind(c, name='H5Aopen_by_name') result(id)
      import :: hid, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: object(*), name(*)
      integer(hid), value :: access, links
      integer(hid) :: id
    end function h5aopen
    function h5adelete(location, object, name, links) bind(c, name='H5Adelete_by_name') result(code)
      import :: hid, c_int, c_char
      integer(hid), value :: location
      character(kind=c_char), intent(in) :: object(*), name(*)
      integer(hid), value :: links
      integer(c_int) :: code
    end function h5adelete
    function h5aget_type(attribute) bind(c, name='H5Aget_type') result(id)
      import :: hid
      integer(hid), value :: attribute
      integer(hid) :: id
    end function h5aget_type
    function h5aget_space(attribute) bind(c, name='H5Aget_space') result(id)
      import :: hid
      integer(hid), value :: attribute
      integer(hid) :: id
    end function h5aget_space
    function h5sget_simple_extent_npoints(space) bind(c, name='H5Sget_simple_extent_npoints') result(count)
      import :: hid, c_int64_t
      integer(hid), value :: space
      integer(c_int64_t) :: count
    end function h5sget_simple_extent_npoints
    function h5awrite(attribute, kind, data) bind(c, name='H5Awrite') result(code)
      import :: hid, c_int, c_ptr
      integer(hid), value :: attribute, kind
      type(c_ptr), value :: data
      integer(c_int) :: code
    end function h5awrite
    function h5aread(attribute, kind, data) bind(c, name='H5Aread') result(code)
      import :: hid, c_int, c_ptr
      integer(hid), value :: attribute, kind
      type(c_ptr), value :: data
      integer(c_int) :: code
    end function h5aread
    function h5aclose(id) bind(c, name='H5Aclose') result(code)
      import :: hid, c_int
      integer(hid), value :: id
      integer(c_int) :: code
    end function h5aclose
  end interface

contains

  ! ---------------------------------------------------------------- files

  subroutine create_draft(self, name)
    !! Write a new file NAME.tmp, which `publish` puts in the place of NAME in one instant.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: name

    integer(hid) :: access

    call self%begin(name, name//'.tmp')
    if (self%failed) return
    access = bezel_h5_file_access()
    self%file = h5fcreate(self%written_name//c_null_char, truncate_old, default_list, max(access, default_list))
    if (access > 0) call ignore(h5pclose(access))
    if (self%file < 0) call self%complain('cannot create '//name//': '//system_error())
  end subroutine create_draft

  subroutine publish(self)
    !! Close a draft and give it its name; a draft that failed is removed and the older file stays.
    class(hdf5_store_type), intent(inout) :: self

    call self%close()
    if (self%failed) then
      if (file_exists(self%written_name)) then
        if (.not. remove_file(self%written_name)) return
      end if
    else if (.not. rename_file(self%written_name, self%name)) then
      call self%complain('cannot rename a file to '//self%name//': '//system_error())
    end if
  end subroutine publish

  subroutine open_to_read(self, name)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: name

    call open_existing(self, name, read_only)
  end subroutine open_to_read

  subroutine open_to_write(self, name)
    !! Change a file that exists; its changes are safe after `close`.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: name

    call open_existing(self, name, read_write)
  end subroutine open_to_write

  subroutine open_existing(self, name, flags)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: name
    integer(c_int), intent(in) :: flags

    integer(hid) :: access

    call self%begin(name, name)
    if (self%failed) return
    if (.not. file_exists(name)) then
      call self%complain('cannot open '//name//': there is no such file')
      return
    end if
    access = bezel_h5_file_access()
    self%file = h5fopen(name//c_null_char, flags, max(access, default_list))
    if (access > 0) call ignore(h5pclose(access))
    if (self%file < 0) call self%complain('cannot open '//name//': it is no sound HDF5 file, or it may not be opened')
  end subroutine open_existing

  subroutine begin(self, name, written_name)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: name, written_name

    integer(c_int) :: code

    if (self%is_open()) call self%close()
    self%failed = .false.
    if (allocated(self%message)) deallocate (self%message)
    self%name = name
    self%written_name = written_name
    ! every file is closed by this module; what the library does at exit crashes when a disk has become full
    if (.not. prepared) call ignore(h5dont_atexit())
    prepared = .true.
    code = h5open()
    if (code >= 0) code = bezel_h5_silence()
    if (code < 0) call self%complain('the HDF5 library does not start')
  end subroutine begin

  subroutine close_file(self)
    class(hdf5_store_type), intent(inout) :: self

    logical :: lost

    if (.not. self%is_open()) return
    lost = h5fflush(self%file, local_scope) < 0
    if (h5fclose(self%file) < 0) lost = .true.
    self%file = -1
    if (lost) call self%complain('cannot write '//self%name//': is the disk full?')
  end subroutine close_file

  pure logical function is_open(self)
    class(hdf5_store_type), intent(in) :: self

    is_open = self%file >= 0
  end function is_open

  subroutine complain(self, message)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: message

    if (self%failed) return
    self%failed = .true.
    self%message = message
  end subroutine complain

  subroutine ignore(code)
    !! For codes of releasing memory, whose failure loses nothing.
    integer(c_int), intent(in) :: code

    if (code < 0) return
  end subroutine ignore

  ! ---------------------------------------------------------------- names

  logical function has(self, path)
    !! Whether there is a group or dataset of this absolute path.
    class(hdf5_store_type), intent(in) :: self
    character(*), intent(in) :: path

    integer :: i

    has = self%is_open()
    if (.not. has) return
    do i = 2, len(path)
      if (i < len(path)) then
        if (path(i+1:i+1) /= '/') cycle
      end if
      has = h5lexists(self%file, path(:i)//c_null_char, default_list) > 0
      if (.not. has) return
    end do
  end function has

  subroutine make_group(self, path)
    !! Make a group and those above it, unless it is there.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path

    integer(hid) :: links, group

    if (self%failed) return
    if (self%has(path)) return
    links = bezel_h5_link_creation()
    group = h5gcreate(self%file, path//c_null_char, links, default_list, default_list)
    if (group < 0) then
      call self%complain('cannot write the group '//path//' of '//self%name)
    else
      call ignore(h5gclose(group))
    end if
    if (links >= 0) call ignore(h5pclose(links))
  end subroutine make_group

  ! ---------------------------------------------------------------- datasets

  subroutine write_any(self, path, kind, shape_, data, growing)
    !! A new dataset. In a growing one the last dimension of Fortran has no limit.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid), intent(in) :: kind            !! type in memory and file
    integer(i8), intent(in) :: shape_(:)        !! in Fortran's order
    type(c_ptr), intent(in) :: data             !! not looked at when the shape is empty
    logical, intent(in) :: growing

    integer(hid) :: space, links, creation, dataset
    integer(i8) :: dims(max_rank), maxdims(max_rank), chunk(max_rank)
    integer :: rank
    logical :: good

    if (self%failed) return
    rank = size(shape_)
    dims(:rank) = shape_(rank:1:-1)
    maxdims(:rank) = dims(:rank)
    creation = bezel_h5_dataset_creation()
    good = creation >= 0
    if (growing) then
      maxdims(1) = -1
      chunk(:rank) = max(dims(:rank), 1_i8)
      chunk(1) = max(1_i8, min(chunk_items / product(chunk(2:rank)), max(chunk(1), 64_i8)))
      if (good) good = h5pset_chunk(creation, int(rank, c_int), chunk) >= 0
    end if
    links = bezel_h5_link_creation()
    space = h5screate_simple(int(rank, c_int), dims, maxdims)
    dataset = -1
    if (good .and. space >= 0 .and. links >= 0) &
      dataset = h5dcreate(self%file, path//c_null_char, kind, space, links, creation, default_list)
    good = dataset >= 0
    if (good .and. product(shape_) > 0) &
      good = h5dwrite(dataset, kind, whole_space, whole_space, default_list, data) >= 0
    if (dataset >= 0) then
      if (h5dclose(dataset) < 0) good = .false.
    end if
    if (space >= 0) call ignore(h5sclose(space))
    if (links >= 0) call ignore(h5pclose(links))
    if (creation >= 0) call ignore(h5pclose(creation))
    if (.not. good) call self%complain('cannot write '//path//' of '//self%name//': is the disk full?')
  end subroutine write_any

  subroutine append_any(self, path, kind, shape_, data)
    !! Lengthen a series along its last dimension; the first call creates it.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid), intent(in) :: kind
    integer(i8), intent(in) :: shape_(:)
    type(c_ptr), intent(in) :: data

    integer(hid) :: dataset, space, memory
    integer(i8) :: old(max_rank), dims(max_rank), start(max_rank)
    integer :: rank
    logical :: good

    if (self%failed) return
    if (.not. self%has(path)) then
      call self%write_any(path, kind, shape_, data, growing=.true.)
      return
    end if
    rank = size(shape_)
    call self%find_shape(path, rank, old)
    if (self%failed) return
    if (any(old(:rank-1) /= shape_(:rank-1))) then
      call self%complain(path//' of '//self%name//' has other dimensions than what shall be added to it')
      return
    end if
    if (product(shape_) == 0) return

    start = 0
    start(1) = old(rank)
    dims(:rank) = shape_(rank:1:-1)
    dims(1) = old(rank) + shape_(rank)
    dataset = h5dopen(self%file, path//c_null_char, default_list)
    good = dataset >= 0
    if (good) then
      good = h5dset_extent(dataset, dims) >= 0
      space = h5dget_space(dataset)
      dims(1) = shape_(rank)
      memory = h5screate_simple(int(rank, c_int), dims, dims)
      if (good) good = space >= 0 .and. memory >= 0
      if (good) good = h5sselect_hyperslab(space, select_set, start, c_null_ptr, dims, c_null_ptr) >= 0
      if (good) good = h5dwrite(dataset, kind, memory, space, default_list, data) >= 0
      if (space >= 0) call ignore(h5sclose(space))
      if (memory >= 0) call ignore(h5sclose(memory))
      if (h5dclose(dataset) < 0) good = .false.
    end if
    if (.not. good) call self%complain('cannot write '//path//' of '//self%name//': is the disk full?')
  end subroutine append_any

  subroutine find_shape(self, path, rank, shape_)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer, intent(in) :: rank                    !! what is expected
    integer(i8), intent(out) :: shape_(max_rank)   !! in Fortran's order

    integer(hid) :: dataset, space
    integer(i8) :: dims(max_rank), maxdims(max_rank)
    logical :: good

    shape_ = 0
    if (self%failed) return
    dataset = -1
    space = -1
    if (self%has(path)) dataset = h5dopen(self%file, path//c_null_char, default_list)
    if (dataset >= 0) space = h5dget_space(dataset)
    good = space >= 0
    if (good) good = h5sget_simple_extent_ndims(space) == rank
    if (good) then
      good = h5sget_simple_extent_dims(space, dims, maxdims) == rank
      shape_(:rank) = dims(rank:1:-1)
    end if
    if (space >= 0) call ignore(h5sclose(space))
    if (dataset >= 0) call ignore(h5dclose(dataset))
    if (.not. good) call self%complain(self%name//' has no array '//path//' of the expected rank')
  end subroutine find_shape

  integer(i8) function length(self, path)
    !! Extent of a dataset's last dimension, 0 if it is not there.
    class(hdf5_store_type), intent(in) :: self
    character(*), intent(in) :: path

    integer(hid) :: dataset, space
    integer(i8) :: dims(max_rank), maxdims(max_rank)
    integer(c_int) :: rank

    length = 0
    if (.not. self%has(path)) return
    dataset = h5dopen(self%file, path//c_null_char, default_list)
    if (dataset < 0) return
    space = h5dget_space(dataset)
    if (space >= 0) then
      rank = h5sget_simple_extent_ndims(space)
      if (rank >= 1 .and. rank <= max_rank) then
        if (h5sget_simple_extent_dims(space, dims, maxdims) == rank) length = dims(1)
      end if
      call ignore(h5sclose(space))
    end if
    call ignore(h5dclose(dataset))
  end function length

  subroutine set_length(self, path, length)
    !! Shorten (or lengthen, with zeros) a series.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(i8), intent(in) :: length   !! wanted extent of the last dimension

    integer(hid) :: dataset, space
    integer(i8) :: dims(max_rank), maxdims(max_rank)
    integer(c_int) :: rank
    logical :: good

    if (self%failed) return
    dataset = -1
    if (self%has(path)) dataset = h5dopen(self%file, path//c_null_char, default_list)
    good = dataset >= 0
    if (good) then
      space = h5dget_space(dataset)
      rank = -1
      if (space >= 0) rank = h5sget_simple_extent_ndims(space)
      good = rank >= 1 .and. rank <= max_rank
      if (good) good = h5sget_simple_extent_dims(space, dims, maxdims) == rank
      if (good) then
        dims(1) = length
        good = h5dset_extent(dataset, dims) >= 0
      end if
      if (space >= 0) call ignore(h5sclose(space))
      if (h5dclose(dataset) < 0) good = .false.
    end if
    if (.not. good) call self%complain('cannot change the length of '//path//' of '//self%name)
  end subroutine set_length

  subroutine read_any(self, path, kind, data)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    integer(hid), intent(in) :: kind
    type(c_ptr), intent(in) :: data     !! large enough for the whole dataset

    integer(hid) :: dataset
    logical :: good

    if (self%failed) return
    dataset = h5dopen(self%file, path//c_null_char, default_list)
    good = dataset >= 0
    if (good) then
      good = h5dread(dataset, kind, whole_space, whole_space, default_list, data) >= 0
      call ignore(h5dclose(dataset))
    end if
    if (.not. good) call self%complain('cannot read '//path//' of '//self%name//': the file is damaged')
  end subroutine read_any

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
    if (kind >= 0) call ignore(h5tclose(kind))
  end subroutine write_text

  subroutine read_text(self, path, text)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path
    character(:), allocatable, target, intent(out) :: text

    integer(hid) :: dataset, kind
    integer :: n

    n = 0
    if (self%has(path) .and. .not. self%failed) then
      dataset = h5dopen(self%file, path//c_null_char, default_list)
      if (dataset >= 0) then
        kind = h5dget_type(dataset)
        if (kind >= 0) then
          n = int(h5tget_size(kind))
          call ignore(h5tclose(kind))
        end if
        call ignore(h5dclose(dataset))
      end if
    end if
    text = repeat(' ', n)
    if (n == 0) then
      call self%complain(self%name//' has no text '//path)
      return
    end if
    kind = bezel_h5_text(int(n, c_size_t), 1_c_int)
    call self%read_any(path, kind, c_loc(text))
    if (kind >= 0) call ignore(h5tclose(kind))
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

  ! ---------------------------------------------------------------- attributes

  subroutine attribute_any(self, path, name, kind, count, data)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path    !! group or dataset that carries the attribute
    character(*), intent(in) :: name
    integer(hid), intent(in) :: kind
    integer, intent(in) :: count        !! 0: a scalar
    type(c_ptr), intent(in) :: data

    integer(hid) :: space, attribute
    integer(i8) :: dims(1)
    logical :: good

    if (self%failed) return
    good = .true.
    if (h5aexists(self%file, path//c_null_char, name//c_null_char, default_list) > 0) &
      good = h5adelete(self%file, path//c_null_char, name//c_null_char, default_list) >= 0
    dims = count
    space = h5screate_simple(int(min(count, 1), c_int), dims, dims)
    attribute = -1
    if (good .and. space >= 0) attribute = h5acreate(self%file, path//c_null_char, name//c_null_char, kind, space, &
      default_list, default_list, default_list)
    good = attribute >= 0
    if (good) good = h5awrite(attribute, kind, data) >= 0
    if (attribute >= 0) then
      if (h5aclose(attribute) < 0) good = .false.
    end if
    if (space >= 0) call ignore(h5sclose(space))
    if (.not. good) call self%complain('cannot write the attribute '//name//' of '//path//' of '//self%name)
  end subroutine attribute_any

  subroutine attribute_text(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    character(*), intent(in), target :: value   !! not empty

    integer(hid) :: kind

    kind = bezel_h5_text(len(value, c_size_t), 0_c_int)
    call self%attribute_any(path, name, kind, 0, c_loc(value))
    if (kind >= 0) call ignore(h5tclose(kind))
  end subroutine attribute_text

  subroutine attribute_l0(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer(i8), intent(in), target :: value

    call self%attribute_any(path, name, bezel_h5_int64(), 0, c_loc(value))
  end subroutine attribute_l0

  subroutine attribute_l1(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer(i8), intent(in), target, contiguous :: value(:)   !! not empty

    call self%attribute_any(path, name, bezel_h5_int64(), size(value), c_loc(value))
  end subroutine attribute_l1

  subroutine attribute_r0(self, path, name, value)
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    real(wp), intent(in), target :: value

    call self%attribute_any(path, name, bezel_h5_real64(), 0, c_loc(value))
  end subroutine attribute_r0

  subroutine read_attribute_any(self, path, name, kind, data)
    !! A scalar attribute.
    class(hdf5_store_type), intent(inout) :: self
    character(*), intent(in) :: path, name
    integer(hid), intent(in) :: kind
    type(c_ptr), intent(in) :: data

    integer(hid) :: attribute, space
    logical :: good

    if (self%failed) return
    attribute = h5aopen(self%file, path//c_null_char, name//c_null_char, default_list, default_list)
    good = attribute >= 0
    if (good) then
      space = h5aget_space(attribute)
      good = space >= 0
      if (good) then
        good = h5sget_simple_extent_npoints(space) == 1
        call ignore(h5sclose(space))
      end if
      if (good) good = h5aread(attribute, kind, data) >= 0
      call ignore(h5aclose(attribute))
    end if
    if (.not. good) call self%complain('cannot read the attribute '//name//' of '//path//' of '//self%name)
  end subroutine read_attribute_any

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

    integer(hid) :: attribute, kind
    integer :: n

    n = 0
    if (.not. self%failed) then
      attribute = h5aopen(self%file, path//c_null_char, name//c_null_char, default_list, default_list)
      if (attribute >= 0) then
        kind = h5aget_type(attribute)
        if (kind >= 0) then
          n = int(h5tget_size(kind))
          call ignore(h5tclose(kind))
        end if
        call ignore(h5aclose(attribute))
      end if
    end if
    value = repeat(' ', n)
    if (n == 0) then
      call self%complain('cannot read the attribute '//name//' of '//path//' of '//self%name)
      return
    end if
    kind = bezel_h5_text(int(n, c_size_t), 0_c_int)
    call self%read_attribute_any(path, name, kind, c_loc(value))
    if (kind >= 0) call ignore(h5tclose(kind))
    value = before_null(value)
  end subroutine read_attribute_text
end module hdf5_store
