module solution_commands
  !! The solution part of a deck, from BATCh to END, read into a list that `analysis` carries out. FEAP's commands keep
  !! their meaning; a loop around TANG without TIME in it is Newton's method, its count the most iterations.
  use kinds, only: wp
  use messages, only: message_log, deck_place
  use deck_record, only: record
  use deck_reader, only: deck
  use path_control, only: path_off, path_auto, by_dissipation, by_arc
  use linear_solver, only: backend_auto, backend_cholmod, backend_umfpack, order_auto, order_amd, order_metis
  implicit none (type, external)
  private
  public :: solution_command, solution_program, read_solution
  public :: do_dt, do_time, do_loop, do_next, do_solve, do_tolerance, do_print, do_line_search, do_cutback, &
    do_backend, do_predictor, do_path

  integer, parameter :: do_dt = 1, do_time = 2, do_loop = 3, do_next = 4, do_solve = 5, do_tolerance = 6, &
    do_print = 7, do_line_search = 8, do_cutback = 9, do_backend = 10, do_predictor = 11, do_path = 12

  type :: solution_command
    integer :: what = 0
    integer :: count = 0            !! LOOP: repetitions; others: switches
    integer :: other = 0            !! LOOP: its NEXT; NEXT: its LOOP; SOLVer: ordering; PATH: wanted iterations
    real(wp) :: value(3) = 0        !! DT: increment; TOL: energy, residual; PATH: first length, largest, last time
    type(deck_place) :: at
  end type solution_command

  type :: solution_program
    type(solution_command), allocatable :: commands(:)
  end type solution_program

  character(10), parameter :: known(14) = [character(10) :: 'TOL', 'DT', 'TIME', 'LOOP', 'NEXT', 'TANG', 'UTAN', &
    'SOLVer', 'PRINt', 'LINEsearch', 'CUTBack', 'PREDictor', 'PATH', 'END']

contains

  subroutine read_solution(input, program, log)
    !! Read from BATCh to END (a deck without BATCh has no commands: an error names what to add).
    type(deck), intent(inout) :: input
    type(solution_program), intent(out) :: program
    type(message_log), intent(inout) :: log
    type(record) :: rec
    type(solution_command) :: command
    integer, allocatable :: open_loops(:)
    integer :: n
    logical :: begun

    allocate (program%commands(0), open_loops(0))
    begun = .false.
    do
      call input%next_command(rec, log)
      if (rec%end_of_deck) exit
      if (.not. begun) then
        select case (rec%key(1))
        case ('batc')
          begun = .true.
        case ('stop')
          exit
        case default
          call rec%add_error(log, 'after the mesh only BATCh is expected, not "'//rec%word(1)//'"', &
            'Put mesh commands before END and solution commands between BATCh and END')
          exit
        end select
        cycle
      end if
      command = solution_command()
      command%at = rec%at
      n = size(program%commands) + 1
      select case (rec%key(1))
      case ('end')
        exit
      case ('tol')
        command%what = do_tolerance
        call rec%number(3, command%value(1), log, 'energy tolerance', 1.0e-12_wp)
        call rec%number(4, command%value(2), log, 'residual tolerance', 0.0_wp)
        if (command%value(1) < 0 .or. command%value(2) < 0 .or. command%value(1) >= 1 .or. command%value(2) >= 1) &
          call rec%add_error(log, 'a tolerance lies between 0 and 1', 'TOL,,1e-12,1e-9 are the defaults')
      case ('dt')
        command%what = do_dt
        call rec%number(3, command%value(1), log, 'time increment')
        if (.not. command%value(1) > 0 .and. .not. rec%is_damaged) &
          call rec%add_error(log, 'the time increment must be positive', 'Write DT,,1 for example')
      case ('time')
        command%what = do_time
      case ('loop')
        command%what = do_loop
        call rec%integer(3, command%count, log, 'number of repetitions', 1)
        if (command%count < 0) call rec%add_error(log, 'a loop cannot run a negative number of times', &
          'Write LOOP,,n with n >= 0')
        open_loops = [open_loops, n]
      case ('next')
        command%what = do_next
        if (size(open_loops) == 0) then
          call rec%add_error(log, 'NEXT without LOOP', 'Remove it, or put LOOP,,n before it')
        else
          command%other = open_loops(size(open_loops))
          program%commands(command%other)%other = n
          open_loops = open_loops(:size(open_loops) - 1)
        end if
      case ('tang', 'utan')
        command%what = do_solve
      case ('solv')
        command%what = do_backend
        call read_backend(rec, command, log)
      case ('prin', 'nopr')
        command%what = do_print
        command%count = merge(1, 0, rec%key(1) == 'prin')
      case ('line')
        command%what = do_line_search
        call rec%number(3, command%value(1), log, 'ratio of the out-of-balance work', 0.8_wp)
      case ('cutb')
        command%what = do_cutback
        call rec%integer(3, command%count, log, 'number of halvings', 10)
      case ('pred')
        command%what = do_predictor
        select case (rec%key(2))
        case ('tang'); command%count = 0
        case ('cont'); command%count = 1
        case default
          call rec%add_error(log, 'unknown predictor "'//rec%word(2)//'"', 'Known predictors: TANGent, CONTinue', 2)
        end select
      case ('path')
        command%what = do_path
        call read_path(rec, command, log)
      case default
        rec%ends_set = .true.  ! a solution command is one line: nothing is skipped
        call input%refuse_command(rec, known, log)
        cycle
      end select
      program%commands = [program%commands, command]
    end do
    do n = 1, size(open_loops)
      call log%add_error(program%commands(open_loops(n))%at, 'LOOP', 'this loop is not closed', &
        'Add NEXT before END')
    end do
    if (begun .and. log%error_count() == 0 .and. .not. any(program%commands%what == do_solve)) &
      call rec%add_warning(log, 'nothing is solved', 'Add TANG,,1 behind TIME')
    if (.not. begun .and. log%error_count() == 0) call rec%add_error(log, 'the deck has no solution commands', &
      'Add BATCh, DT,,1, TIME, TANG,,1, END after the mesh')
  end subroutine read_solution

  subroutine read_path(rec, command, log)
    !! PATH AUTO|DISSipation|ARClength|OFF [LENGth=s] [MOST=s] [ITERations=n] [UNTIl=t]
    type(record), intent(inout) :: rec
    type(solution_command), intent(inout) :: command
    type(message_log), intent(inout) :: log

    select case (rec%key(2))
    case ('auto', ''); command%count = path_auto
    case ('diss'); command%count = by_dissipation
    case ('arcl', 'arc'); command%count = by_arc
    case ('off'); command%count = path_off
    case default
      call rec%add_error(log, 'unknown control of the path "'//rec%word(2)//'"', &
        'Known: AUTO, DISSipation, ARClength, OFF', 2)
    end select
    command%other = 6
    command%value = [0.0_wp, huge(1.0_wp), huge(1.0_wp)]
    call rec%number_option('length', command%value(1), log)
    call rec%number_option('most', command%value(2), log)
    call rec%number_option('until', command%value(3), log)
    call rec%integer_option('iterations', command%other, log)
    call rec%check_options([character(10) :: 'length', 'most', 'iterations', 'until'], log)
    if (rec%has('length') .and. .not. command%value(1) > 0) call rec%add_error(log, 'the length must be positive', &
      'It is the first arc [length] or the first dissipated energy; leave it out to begin with DT', rec%find('length'))
    if (.not. command%value(2) > 0) call rec%add_error(log, 'the largest length must be positive', '', rec%find('most'))
    if (command%other < 1) call rec%add_error(log, 'at least one iteration is wanted', 'Write ITERations=6', &
      rec%find('iterations'))
  end subroutine read_path

  subroutine read_backend(rec, command, log)
    type(record), intent(inout) :: rec
    type(solution_command), intent(inout) :: command
    type(message_log), intent(inout) :: log
    integer :: i

    command%count = backend_auto
    command%other = order_auto
    do i = 2, rec%count
      select case (rec%key(i))
      case ('auto'); command%count = backend_auto
      case ('chol'); command%count = backend_cholmod
      case ('umfp'); command%count = backend_umfpack
      case ('amd'); command%other = order_amd
      case ('meti'); command%other = order_metis
      case ('')
      case default
        call rec%add_error(log, 'unknown solver or ordering "'//rec%word(i)//'"', &
          'Known solvers: AUTO, CHOLmod, UMFPack; orderings: AMD, METIs', i)
      end select
    end do
  end subroutine read_backend
end module solution_commands
