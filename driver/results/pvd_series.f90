module pvd_series
  !! The list of files that ParaView opens as one animation. It is replaced as a whole after every output.
  use kinds, only: wp
  use byte_file, only: byte_file_type
  use file_system, only: read_text_file, file_exists
  use shortest_text, only: real_text
  use result_frame, only: named_text_type
  implicit none (type, external)
  private
  public :: pvd_series_type

  type :: pvd_series_type
    character(:), allocatable :: path
    integer :: n = 0                                 !! files in the list
    real(wp), allocatable :: times(:)
    type(named_text_type), allocatable :: files(:)   !! `text` is the name, relative to the list
  contains
    procedure :: begin
    procedure :: resume
    procedure :: add
  end type pvd_series_type

contains

  subroutine begin(self, path)
    class(pvd_series_type), intent(out) :: self
    character(*), intent(in) :: path

    self%path = path
    allocate (self%times(0), self%files(0))
  end subroutine begin

  subroutine resume(self, path, time, message)
    !! Read a list back and forget what comes after a time.
    class(pvd_series_type), intent(out) :: self
    character(*), intent(in) :: path
    real(wp), intent(in) :: time
    character(:), allocatable, intent(out) :: message    !! what failed, unallocated when all is well

    character(:), allocatable :: text, file
    real(wp) :: at
    integer :: from, next, code
    logical :: failed

    call self%begin(path)
    if (.not. file_exists(path)) return
    call read_text_file(path, text, failed)
    if (failed) then
      message = 'cannot read '//path
      return
    end if
    from = 1
    do
      next = index(text(from:), 'timestep="')
      if (next == 0) exit
      from = from + next + 9
      file = text(from:from+index(text(from:), '"')-2)
      read (file, *, iostat=code) at
      next = index(text(from:), 'file="')
      if (code /= 0 .or. next == 0) exit
      from = from + next + 5
      file = text(from:from+index(text(from:), '"')-2)
      if (at <= time) call extend(self, at, file)
    end do
    call write_list(self, message)
  end subroutine resume

  subroutine add(self, time, file, message)
    class(pvd_series_type), intent(inout) :: self
    real(wp), intent(in) :: time
    character(*), intent(in) :: file                     !! relative to the list
    character(:), allocatable, intent(out) :: message    !! what failed, unallocated when all is well

    call extend(self, time, file)
    call write_list(self, message)
  end subroutine add

  subroutine extend(self, time, file)
    class(pvd_series_type), intent(inout) :: self
    real(wp), intent(in) :: time
    character(*), intent(in) :: file

    type(named_text_type), allocatable :: longer(:)

    if (self%n == size(self%files)) then
      allocate (longer(2*self%n + 16))
      longer(:self%n) = self%files
      call move_alloc(longer, self%files)
      self%times = [self%times, spread(0.0_wp, 1, self%n + 16)]
    end if
    self%n = self%n + 1
    self%times(self%n) = time
    self%files(self%n)%text = file
  end subroutine extend

  subroutine write_list(self, message)
    class(pvd_series_type), intent(in) :: self
    character(:), allocatable, intent(out) :: message

    type(byte_file_type) :: file
    integer :: i

    call file%create_draft(self%path)
    call file%put_line('<?xml version="1.0"?>')
    call file%put_line('<VTKFile type="Collection" version="1.0">')
    call file%put_line('<Collection>')
    do i = 1, self%n
      call file%put_line('<DataSet timestep="'//real_text(self%times(i))//'" part="0" file="'// &
        self%files(i)%text//'"/>')
    end do
    call file%put_line('</Collection>')
    call file%put_line('</VTKFile>')
    call file%publish()
    if (file%failed) message = file%message
  end subroutine write_list
end module pvd_series
