module hdf5_binding
  !! What the program uses of the C interface of HDF5 1.10 and later, under HDF5's own names and with its argument
  !! order: identifiers and flags, and the functions of files (h5f), property lists (h5p), groups and links (h5g, h5l),
  !! dataspaces (h5s), datasets (h5d), types (h5t) and attributes (h5a). A negative identifier or code is a failure.
  !!
  !! HDF5 Reference Manual, The HDF Group.
  use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_size_t, c_char, c_ptr
  implicit none (type, external)
  private
  public :: hid, default_list, whole_space, read_only, read_write, truncate_old, select_set, local_scope
  public :: bezel_h5_real64, bezel_h5_int32, bezel_h5_int64, bezel_h5_uint8, bezel_h5_text
  public :: bezel_h5_link_creation, bezel_h5_dataset_creation, bezel_h5_file_access, bezel_h5_silence
  public :: h5dont_atexit, h5open
  public :: h5fcreate, h5fopen, h5fflush, h5fclose
  public :: h5pclose, h5pset_chunk
  public :: h5gcreate, h5gclose
  public :: h5lexists
  public :: h5screate_simple, h5sclose, h5sselect_hyperslab, h5sget_simple_extent_ndims
  public :: h5sget_simple_extent_dims, h5sget_simple_extent_npoints
  public :: h5dcreate, h5dopen, h5dclose, h5dget_space, h5dget_type, h5dset_extent, h5dwrite, h5dread
  public :: h5tget_size, h5tclose
  public :: h5aexists, h5acreate, h5aopen, h5adelete, h5aget_type, h5aget_space, h5awrite, h5aread, h5aclose

  integer, parameter :: hid = c_int64_t                                          !! kind of an identifier
  integer(hid), parameter :: default_list = 0, whole_space = 0                   ! H5P_DEFAULT, H5S_ALL
  integer(c_int), parameter :: read_only = 0, read_write = 1, truncate_old = 2   ! H5F_ACC_RDONLY, _RDWR, _TRUNC
  integer(c_int), parameter :: select_set = 0                                    ! H5S_SELECT_SET
  integer(c_int), parameter :: local_scope = 0                                   ! H5F_SCOPE_LOCAL

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
end module hdf5_binding
