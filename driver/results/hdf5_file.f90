module hdf5_file
  !! An HDF5 file and what is in it, without regard to the type of the values: opening and closing, groups, datasets
  !! that are written and read as bytes of a given HDF5 type, series that grow along their last dimension, attributes.
  !! Module hdf5_store puts Fortran's types on top.
  !!
  !! Nothing stops or prints: the first failure is kept with its message, later calls do nothing, so that a caller may
  !! write a whole file and look once. A new file appears under its name only when it is complete.
  use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr, c_null_char
  use kinds, only: i8
  use file_system, only: rename_file, remove_file, file_exists, system_error
  use hdf5_binding, only: hid, default_list, whole_space, read_only, read_write, truncate_old, select_set, &
    local_scope, bezel_h5_link_creation, bezel_h5_dataset_creation, bezel_h5_file_access, bezel_h5_silence, &
    h5dont_atexit, h5open, h5fcreate, h5fopen, h5fflush, h5fclose, h5pclose, h5pset_chunk, h5gcreate, &
    h5gclose, h5lexists, h5screate_simple, h5sclose, h5sselect_hyperslab, h5sget_simple_extent_ndims, &
    h5sget_simple_extent_dims, h5dcreate, h5dopen, h5dclose, h5dget_space, h5dget_type, h5dset_extent, &
    h5dwrite, h5dread, h5tget_size, h5tclose, h5aexists, h5acreate, h5aopen, h5adelete, h5aget_type, &
    h5aget_space, h5sget_simple_extent_npoints, h5awrite, h5aread, h5aclose
  implicit none (type, external)
  private
  public :: hdf5_file_type, max_rank

  integer, parameter :: max_rank = 3                     !! of a dataset
  integer(i8), parameter :: chunk_items = 32768          !! wanted items in a chunk of a series

  logical, save :: prepared = .false.    !! the library has been told what to leave out, once for the process

  type :: hdf5_file_type
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
    procedure :: complain
    procedure :: has
    procedure :: make_group
    procedure :: length
    procedure :: set_length
    procedure :: find_shape
    procedure :: write_any
    procedure :: append_any
    procedure :: read_any
    procedure :: text_length
    procedure :: write_attribute_any
    procedure :: read_attribute_any
    procedure :: attribute_length
    procedure, private :: begin
  end type hdf5_file_type

contains

  ! ---------------------------------------------------------------- files

  subroutine create_draft(self, name)
    !! Write a new file NAME.tmp, which `publish` puts in the place of NAME in one instant.
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self

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
    class(hdf5_file_type), intent(inout) :: self
    character(*), intent(in) :: name

    call open_existing(self, name, read_only)
  end subroutine open_to_read

  subroutine open_to_write(self, name)
    !! Change a file that exists; its changes are safe after `close`.
    class(hdf5_file_type), intent(inout) :: self
    character(*), intent(in) :: name

    call open_existing(self, name, read_write)
  end subroutine open_to_write

  subroutine open_existing(self, name, flags)
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self

    logical :: lost

    if (.not. self%is_open()) return
    lost = h5fflush(self%file, local_scope) < 0
    if (h5fclose(self%file) < 0) lost = .true.
    self%file = -1
    if (lost) call self%complain('cannot write '//self%name//': is the disk full?')
  end subroutine close_file

  pure logical function is_open(self)
    class(hdf5_file_type), intent(in) :: self

    is_open = self%file >= 0
  end function is_open

  subroutine complain(self, message)
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(in) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(in) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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
    class(hdf5_file_type), intent(inout) :: self
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

  integer function text_length(self, path)
    !! Length of a text, its end of null included, 0 if it is not there.
    class(hdf5_file_type), intent(in) :: self
    character(*), intent(in) :: path

    integer(hid) :: dataset

    text_length = 0
    if (self%failed) return
    if (.not. self%has(path)) return
    dataset = h5dopen(self%file, path//c_null_char, default_list)
    if (dataset < 0) return
    text_length = type_length(h5dget_type(dataset))
    call ignore(h5dclose(dataset))
  end function text_length

  ! ---------------------------------------------------------------- attributes

  subroutine write_attribute_any(self, path, name, kind, count, data)
    class(hdf5_file_type), intent(inout) :: self
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
  end subroutine write_attribute_any

  subroutine read_attribute_any(self, path, name, kind, data)
    !! A scalar attribute.
    class(hdf5_file_type), intent(inout) :: self
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

  integer function attribute_length(self, path, name)
    !! Length of an attribute that is a text, 0 if it is not there.
    class(hdf5_file_type), intent(in) :: self
    character(*), intent(in) :: path, name

    integer(hid) :: attribute

    attribute_length = 0
    if (self%failed) return
    attribute = h5aopen(self%file, path//c_null_char, name//c_null_char, default_list, default_list)
    if (attribute < 0) return
    attribute_length = type_length(h5aget_type(attribute))
    call ignore(h5aclose(attribute))
  end function attribute_length

  integer function type_length(kind)
    integer(hid), intent(in) :: kind   !! released here; negative: not there

    type_length = 0
    if (kind < 0) return
    type_length = int(h5tget_size(kind))
    call ignore(h5tclose(kind))
  end function type_length
end module hdf5_file
