/* The few facts of the C library and of HDF5 that exist only as macros or global variables of C headers. */
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <hdf5.h>

_Static_assert(sizeof(hid_t) == 8, "HDF5 1.10 or newer is needed");

/* What the last failed call of the C library complained about. */
void bezel_error_text(char *text, int length)
{
  snprintf(text, (size_t)length, "%s", errno ? strerror(errno) : "unknown reason");
}

void bezel_clear_error(void) { errno = 0; }

/* Types in memory, equal to those in files written on this machine. */
hid_t bezel_h5_real64(void) { return H5T_NATIVE_DOUBLE; }
hid_t bezel_h5_int32(void) { return H5T_NATIVE_INT32; }
hid_t bezel_h5_int64(void) { return H5T_NATIVE_INT64; }
hid_t bezel_h5_uint8(void) { return H5T_NATIVE_UINT8; }

/* A new type for strings of a fixed length, padded with nulls. */
hid_t bezel_h5_text(size_t length, int utf8)
{
  hid_t type = H5Tcopy(H5T_C_S1);
  if (type < 0) return type;
  if (H5Tset_size(type, length ? length : 1) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0
      || H5Tset_cset(type, utf8 ? H5T_CSET_UTF8 : H5T_CSET_ASCII) < 0) {
    H5Tclose(type);
    return -1;
  }
  return type;
}

/* New property lists. */
hid_t bezel_h5_link_creation(void)
{
  hid_t list = H5Pcreate(H5P_LINK_CREATE);
  if (list >= 0) H5Pset_create_intermediate_group(list, 1);
  return list;
}

hid_t bezel_h5_dataset_creation(void) { return H5Pcreate(H5P_DATASET_CREATE); }

/* No locks: a viewer that reads the file must not stop the run that extends it. */
hid_t bezel_h5_file_access(void)
{
  hid_t list = H5Pcreate(H5P_FILE_ACCESS);
#if H5_VERSION_GE(1, 10, 7)
  if (list >= 0) H5Pset_file_locking(list, false, true);
#endif
  return list;
}

/* No error stack on the terminal: codes are checked by the caller. */
int bezel_h5_silence(void) { return (int)H5Eset_auto2(H5E_DEFAULT, NULL, NULL); }
