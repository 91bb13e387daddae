module deck_runs
  !! Decks solved within tests and studies, without result files: the model, its state and its Newton reports stay at hand.
  use kinds, only: wp
  use status_codes, only: ok
  use messages, only: message_log
  use deck_reader, only: deck, setting
  use model_data, only: model_type
  use mesh_commands, only: read_model
  use equilibrium, only: equilibrium_type, start_equilibrium
  use newton, only: newton_settings
  use step_control, only: step_control_type, step_report, start_control, advance
  use timers, only: timer_set
  use deck_files, only: write_lines, remove_file
  implicit none (type, external)
  private
  public :: deck_run, project_file

  type :: deck_run
    type(model_type) :: model
    type(equilibrium_type) :: eq
    type(newton_settings) :: settings
    type(step_control_type) :: control
    type(step_report) :: report           !! of the last step
    type(timer_set) :: clock
    integer :: deck_errors = 0            !! messages of the deck; the first is in `fault`
    character(:), allocatable :: fault
  contains
    procedure :: open_file
    procedure :: open_lines
    procedure :: solve_to
  end type deck_run

contains

  function project_file(path) result(full)
    !! A file of the project, whose folder ctest puts into BEZEL_SOURCE.
    character(*), intent(in) :: path
    character(:), allocatable :: full
    integer :: n, status

    call get_environment_variable('BEZEL_SOURCE', length=n, status=status)
    if (status /= 0 .or. n == 0) error stop 'BEZEL_SOURCE must name the folder of the project (ctest sets it)'
    allocate (character(n) :: full)
    call get_environment_variable('BEZEL_SOURCE', full)
    full = full//'/'//path
  end function project_file

  subroutine open_file(self, path, settings)
    !! Read the mesh part of a deck and prepare its equilibrium.
    class(deck_run), intent(inout), target :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: settings(:)     !! name=value, as on the command line
    type(setting) :: items(size(settings))
    type(message_log) :: log
    type(deck) :: input
    integer :: i, k, status

    do i = 1, size(settings)
      k = index(settings(i), '=')
      items(i)%name = settings(i)(1:k - 1)
      items(i)%text = trim(settings(i)(k + 1:))
    end do
    self%fault = ''
    call self%clock%reset()
    call input%open(path, items, log)
    call read_model(input, self%model, log)
    call input%finish(log)
    call input%close()
    self%deck_errors = log%error_count()
    if (self%deck_errors > 0) then
      self%fault = log%message_text(1)
      return
    end if
    call start_equilibrium(self%model, self%eq, self%clock, status)
    if (status /= ok) then
      self%deck_errors = 1
      self%fault = self%eq%fault
      return
    end if
    call start_control(self%control, self%model)
  end subroutine open_file

  subroutine open_lines(self, lines)
    !! The same from text; FEAP's line, 2D counts and END are added.
    class(deck_run), intent(inout), target :: self
    character(*), intent(in) :: lines(:)
    character(*), parameter :: path = 'test_run_deck.inp'
    character(max(16, len(lines))) :: all_lines(size(lines) + 3)
    character(1) :: none(0)

    all_lines(1) = 'FEAP * * test'
    all_lines(2) = '0 0 0 2 2'
    all_lines(3:size(lines) + 2) = lines
    all_lines(size(lines) + 3) = 'END'
    call write_lines(path, all_lines)
    call self%open_file(path, none)
    call remove_file(path)
  end subroutine open_lines

  subroutine solve_to(self, time, status)
    !! One step of step control.
    class(deck_run), intent(inout), target :: self
    real(wp), intent(in) :: time
    integer, intent(out) :: status

    call advance(self%model, self%eq, self%settings, self%control, time, self%clock, self%report, status)
  end subroutine solve_to
end module deck_runs
