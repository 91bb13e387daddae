! What Abaqus provides to user routines.

subroutine getoutdir(outdir, length)
  use adapter_benchmarks, only: job_folder
  implicit none (type, external)
  character(256), intent(out) :: outdir
  integer, intent(out) :: length

  outdir = job_folder
  length = len_trim(job_folder)
end subroutine getoutdir

subroutine getjobname(name, length)
  implicit none (type, external)
  character(256), intent(out) :: name
  integer, intent(out) :: length

  name = 'benchmark'
  length = 9
end subroutine getjobname

subroutine stdb_abqerr(lop, string, intv, realv, charv)
  implicit none (type, external)
  integer, intent(in) :: lop, intv(1)
  character(500), intent(in) :: string
  real(8), intent(in) :: realv(1)
  character(8), intent(in) :: charv(1)

  print *, trim(string), lop, intv, realv, charv
end subroutine stdb_abqerr

subroutine xit
  implicit none (type, external)

  error stop 'benchmark: UEL ends the analysis'
end subroutine xit
