module model_benchmarks
  !! Whole models: input and preparation, assembly through the one user-element interface, pattern, solver, output.
  use kinds, only: wp
  use status_codes, only: ok
  use deck_files, only: write_lines, remove_file
  use deck_runs, only: deck_run
  use equilibrium, only: form_equilibrium
  use path_control, only: path_control_type
  use bulk_elements, only: prepare_bulk, assemble_bulk
  use interface_points, only: pair_interface, assemble_interface
  use interface_pattern, only: pair_lists
  use user_element, only: element_energy, task_residual, task_tangent
  use run_results, only: run_results_type
  use result_frame, only: named_text_type
  use stopwatch, only: stopwatch_type
  use report, only: put, text
  implicit none (type, external)
  private
  public :: measure_assembly, measure_system

contains

  subroutine block_deck(ndm, basis, p, n, path)
    !! A neo-Hookean block of n elements a direction, a rational patch when it is NURBS.
    integer, intent(in) :: ndm, p, n
    character(1), intent(in) :: basis
    character(*), intent(in) :: path
    character(40) :: lines(40)
    integer :: d, i, j, k, m

    lines = ''
    lines(1) = 'FEAP * * block'
    write (lines(2), '(a,2(1x,i0))') '0 0 0', ndm, ndm
    lines(3) = 'PATCh block'
    lines(4) = '  DEGRee'//repeat(' 1', ndm)
    m = 4
    do d = 1, ndm
      m = m + 1
      lines(m) = '  KNOTs '//text(d)//' 0 0 1 1'
    end do
    m = m + 1
    lines(m) = '  POINts'
    do k = 0, merge(1, 0, ndm == 3)
      do j = 0, 1
        do i = 0, 1
          m = m + 1
          write (lines(m), '(3(1x,i0))') i, j
          if (ndm == 3) write (lines(m), '(3(1x,i0))') i, j, k
          lines(m) = trim(lines(m))//merge(' 1.0', ' 0.9', i == 0)
        end do
      end do
    end do
    if (basis == 'N' .and. p > 1) then
      m = m + 1
      lines(m) = '  ELEVate TO'//repeat(' '//text(p), ndm)
    end if
    do d = 1, ndm
      m = m + 1
      lines(m) = '  SUBDivide '//text(d)//' '//text(n)
    end do
    if (basis == 'L') then
      m = m + 1
      lines(m) = '  LAGRange'//repeat(' '//text(p), ndm)
    end if
    lines(m + 2) = 'MATErial 1'
    lines(m + 3) = '  SOLId'
    lines(m + 4) = '  ELAStic NEOHook 1 0.3'
    lines(m + 6) = 'BOUNdary'
    lines(m + 7) = '  block.left'//repeat(' 1', ndm)
    lines(m + 9) = 'END'
    call write_lines(path, lines(1:m + 9))
  end subroutine block_deck

  subroutine measure_assembly(scratch, ndm, basis, p, n)
    !! One pass over the elements: gather, element, scatter into the sparse matrix.
    character(*), intent(in) :: scratch
    integer, intent(in) :: ndm, p, n
    character(1), intent(in) :: basis
    type(deck_run), target :: run
    type(stopwatch_type) :: watch
    character(1) :: no_settings(0)
    character(:), allocatable :: row
    integer :: status, place

    call block_deck(ndm, basis, p, n, scratch//'/block.inp')
    call run%open_file(scratch//'/block.inp', no_settings)
    call remove_file(scratch//'/block.inp')
    if (run%deck_errors > 0) error stop 'model_benchmarks: '//run%fault
    row = text(ndm)//'D p = '//text(p)
    call time_assembly(run, 'element', row, basis)
    if (basis == 'L') return
    call watch%begin()
    do while (watch%goes_on())
      call prepare_bulk(run%model, run%eq%bulk, status, place)
    end do
    call put('element', row, 'preparation, once [us]', 1.0e6_wp*watch%best/run%model%mesh%ne)
    call put('element', row, 'memory of the table [kB]', 8.0e-3_wp*size(run%eq%bulk%table)/run%model%mesh%ne)
  end subroutine measure_assembly

  subroutine time_assembly(run, group, row, basis)
    type(deck_run), intent(inout), target :: run
    character(*), intent(in) :: group, row
    character(1), intent(in) :: basis
    type(stopwatch_type) :: watch
    real(wp) :: stored, dissipated, none(0, 0)
    integer :: pass, status, place, tasks(2)
    character(*), parameter :: what(2) = [character(20) :: 'residual', 'residual and tangent']

    tasks = [task_residual, task_tangent]
    stored = 0
    dissipated = 0
    associate (eq => run%eq)
      call form_equilibrium(run%model, eq, .true., none, [logical ::], run%clock, status)
      if (status /= ok) error stop 'model_benchmarks: no tangent'
      do pass = 1, 2
        call watch%begin()
        do while (watch%goes_on())
          eq%f = 0
          if (pass == 2) call eq%system%clear()
          call assemble_bulk(run%model, eq%bulk, tasks(pass), eq%u, eq%un, none, [logical ::], eq%time, 1.0_wp, eq%system, &
                             eq%f, eq%f_moved, stored, dissipated, status, place)
        end do
        call put(group, row, trim(what(pass))//', assembled, '//trim(merge('NURBS   ', 'Lagrange', basis == 'N'))//' [us]', &
                 1.0e6_wp*watch%best/run%model%mesh%ne)
      end do
    end associate
  end subroutine time_assembly

  subroutine measure_system(project, scratch, mesh)
    !! The ironing problem with cubic NURBS, pressed in by three steps.
    character(*), intent(in) :: project, scratch
    integer, intent(in) :: mesh
    type(deck_run), target :: run
    character(8) :: settings(2)
    character(:), allocatable :: row
    real(wp) :: none(0, 0)
    integer :: status, step

    settings = [character(8) :: 'mesh='//text(mesh), 'basis=N']
    call run%open_file(project//'/inputs/ironing.inp', settings)
    if (run%deck_errors > 0) error stop 'model_benchmarks: '//run%fault
    do step = 1, 3
      call run%solve_to(real(step, wp), status)
      if (status /= ok) error stop 'model_benchmarks: the ironing problem fails'
    end do
    call form_equilibrium(run%model, run%eq, .true., none, [logical ::], run%clock, status)
    if (status /= ok) error stop 'model_benchmarks: no tangent'
    row = text(size(run%model%x))//' dofs'
    call time_solver(run, row)
    call time_interface(run, row)
    call time_output(run, scratch//'/output', row)
  end subroutine measure_system

  subroutine time_solver(run, row)
    type(deck_run), intent(inout), target :: run
    character(*), intent(in) :: row
    type(stopwatch_type) :: watch
    integer, allocatable :: ptr(:), nodes(:)
    real(wp), allocatable :: dq(:)
    integer :: status

    allocate (dq(run%eq%system%map%neq))
    associate (eq => run%eq)
      call watch%begin()
      do while (watch%goes_on())
        ptr = [1]
        if (allocated(nodes)) deallocate (nodes)
        allocate (nodes(0))
        call pair_lists(eq%interfaces(1), ptr, nodes)
        call eq%system%rebuild(run%model, ptr, nodes, status)
      end do
      call put('system', row, 'pattern [ms]', 1.0e3_wp*watch%best)
      call watch%begin()
      do while (watch%goes_on())
        call eq%solver%release()
        call eq%solver%analyse(eq%system%matrix%pattern, status)
      end do
      call put('system', row, 'ordering and analysis [ms]', 1.0e3_wp*watch%best)
      call time_assembly(run, 'system', row, 'N')
      call watch%begin()
      do while (watch%goes_on())
        call eq%solver%factorise(eq%system%matrix, status)
      end do
      call put('system', row, 'factorisation [ms]', 1.0e3_wp*watch%best)
      call watch%begin()
      do while (watch%goes_on())
        call eq%solver%solve(eq%r, dq, status)
      end do
      call put('system', row, 'solution [ms]', 1.0e3_wp*watch%best)
      if (status /= ok) error stop 'model_benchmarks: no solution'
    end associate
  end subroutine time_solver

  subroutine time_interface(run, row)
    type(deck_run), intent(inout), target :: run
    character(*), intent(in) :: row
    type(stopwatch_type) :: watch
    type(element_energy) :: sums
    real(wp), allocatable :: x(:, :)
    real(wp) :: none(0, 0)
    integer :: status, place

    x = run%model%x + run%eq%u
    associate (eq => run%eq)
      call watch%begin()
      do while (watch%goes_on())
        call pair_interface(run%model, eq%interfaces(1), x)
      end do
      call put('system', row, 'search [ms]', 1.0e3_wp*watch%best)
      call watch%begin()
      do while (watch%goes_on())
        call assemble_interface(run%model, 1, eq%interfaces(1), task_tangent, eq%u, eq%un, none, [logical ::], eq%time, &
                                1.0_wp, eq%system, eq%f, eq%f_moved, sums, status, place)
      end do
      call put('system', row, 'interface points [ms]', 1.0e3_wp*watch%best)
    end associate
  end subroutine time_interface

  subroutine time_output(run, folder, row)
    !! Fields of one step (.vtu, results.vtkhdf, lists) and a restart state.
    type(deck_run), intent(inout), target :: run
    character(*), intent(in) :: folder, row
    type(run_results_type) :: results
    type(named_text_type) :: provenance(1)
    type(stopwatch_type) :: watch
    type(path_control_type) :: following
    integer :: step

    provenance(1) = named_text_type('deck', 'benchmark')
    results%identity = 'benchmark'
    call results%folder%begin(folder)
    call results%begin(run%model, provenance)
    step = 0
    call watch%begin()
    do while (watch%goes_on())
      step = step + 1
      call results%write_fields(run%model, run%eq, step)
    end do
    call put('system', row, 'output of a step, an element [us]', 1.0e6_wp*watch%best/run%model%mesh%ne)
    call watch%begin()
    do while (watch%goes_on())
      call results%write_state(run%eq, run%control, following, step)
    end do
    call put('system', row, 'restart state [ms]', 1.0e3_wp*watch%best)
    if (allocated(results%fault)) error stop 'model_benchmarks: '//results%fault
  end subroutine time_output
end module model_benchmarks
