module abaqus_state
  !! The job that is being run, and how it is stopped.
  use abaqus_job, only: job_type
  implicit none (type, external)
  private
  public :: job, has_job, tell, stop_analysis
  type(job_type), save, target :: job
  logical, save :: has_job = .false.

contains

  subroutine tell(level, text, numbers)
    integer, intent(in) :: level                  !! 1: a note, -3: ends the analysis
    character(*), intent(in) :: text              !! %I: the next of the numbers
    integer, intent(in) :: numbers(:)
    external :: stdb_abqerr
    character(500) :: line
    character(8) :: words(1)

    line = text
    words = ' '
    call stdb_abqerr(level, line, numbers, [0.0d0], words)
  end subroutine tell

  subroutine stop_analysis(text, numbers)
    character(*), intent(in) :: text
    integer, intent(in) :: numbers(:)
    external :: xit

    call tell(-3, text, numbers)
    call xit
  end subroutine stop_analysis
end module abaqus_state
