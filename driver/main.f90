program bezel
  !! bezel DECK [name=value ...] [--out DIR] [--check] [--restart] [--help] [--version]
  !! bezel --check MESH
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use messages, only: message_log
  use command_line, only: command_options, read_command_line, usage_text
  use deck_reader, only: deck
  use model_data, only: model_type
  use mesh_commands, only: read_model, describe_model
  use mesh_files, only: is_mesh_file, check_mesh_file
  use mesh_exports, only: write_exports
  use solution_commands, only: solution_program, read_solution
  use result_frame, only: named_text_type
  use run_results, only: run_results_type
  use run_log, only: log_type
  use timers, only: timer_set, phase_input
  use analysis, only: run_analysis, exit_done, exit_deck, exit_machine
  use build_info, only: version, compiler, build_type, build_flags
  implicit none (type, external)
  type(command_options) :: options
  type(message_log) :: messages_of_deck
  type(deck) :: input
  type(model_type), target :: model
  type(solution_program) :: commands
  type(run_results_type) :: results
  type(named_text_type), allocatable :: provenance(:)
  type(log_type) :: log
  type(timer_set) :: clock
  character(:), allocatable :: message, parameters
  integer :: code, i
  interface
    subroutine raise_stack_limit() bind(c, name='bezel_raise_stack_limit')
    end subroutine raise_stack_limit
  end interface

  call raise_stack_limit()
  call clock%reset()
  call read_command_line(options, messages_of_deck)
  if (options%help) then
    write (output_unit, '(a)') usage_text()
    call leave(exit_done)
  else if (options%version) then
    write (output_unit, '(a)') 'bezel '//version//', '//compiler//', '//build_type
    call leave(exit_done)
  end if
  if (messages_of_deck%error_count() > 0) call refuse()
  if (is_mesh_file(options%deck)) then
    call check_mesh_file(options%deck, options%check, output_unit, messages_of_deck)
    if (messages_of_deck%error_count() > 0) call refuse()
    call leave(exit_done)
  end if

  call clock%start(phase_input)
  call input%open(options%deck, options%settings, messages_of_deck)
  call read_model(input, model, messages_of_deck)
  call read_solution(input, commands, messages_of_deck)
  call input%finish(messages_of_deck)
  if (messages_of_deck%error_count() > 0) call refuse()
  call messages_of_deck%show(error_unit)
  call clock%stop(phase_input)

  parameters = ''
  do i = 1, input%parameters%count()
    parameters = parameters//input%parameters%name(i)//' = '//input%parameters%text(i)//new_line('a')
  end do
  if (options%check) then
    call describe_model(model, output_unit)
    call leave(exit_done)
  end if

  if (options%restart) then
    call results%folder%resume(options%folder)
  else
    call results%folder%begin(options%folder)
  end if
  if (results%folder%failed) then
    write (error_unit, '(a)') results%folder%message
    call leave(merge(exit_deck, exit_machine, options%restart))
  end if
  if (options%restart) then
    call log%resume(results%folder%file('log.txt'))
  else
    call log%begin(results%folder%file('log.txt'))
  end if
  if (log%failed) then
    write (error_unit, '(a)') log%message
    call leave(exit_machine)
  end if

  results%identity = input%full_text()//new_line('a')//parameters
  provenance = [named_text_type('deck', input%full_text()), named_text_type('parameters', parameters), &
    named_text_type('version', version), named_text_type('compiler', compiler), &
    named_text_type('build', build_type//' '//build_flags)]
  call log%put('bezel '//version//'  '//input%title)
  call write_exports(model, results%folder, message)
  if (allocated(message)) then
    call log%put('error: '//message)
    call leave(exit_machine)
  end if
  call run_analysis(model, commands, results, provenance, options%restart, log, clock, code)
  call log%close()
  call leave(code)

contains

  subroutine refuse()
    !! Errors of the deck or of the command line: all of them, then exit 2.
    call messages_of_deck%show(error_unit)
    call leave(exit_deck)
  end subroutine refuse

  subroutine leave(status)
    !! End with an exit status, without the noise of STOP.
    use, intrinsic :: iso_c_binding, only: c_int
    integer, intent(in) :: status
    interface
      subroutine c_exit(status) bind(c, name='exit')
        import :: c_int
        integer(c_int), value :: status
      end subroutine c_exit
    end interface

    flush (output_unit)
    flush (error_unit)
    call c_exit(int(status, c_int))
  end subroutine leave
end program bezel
