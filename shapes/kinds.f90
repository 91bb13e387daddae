module kinds
  !! Numeric kinds of the whole project.
  use, intrinsic :: iso_fortran_env, only: real64, int64
  implicit none (type, external)
  private
  public :: wp, i8

  integer, parameter :: wp = real64  !! reals
  integer, parameter :: i8 = int64   !! offsets into long stores
end module kinds
