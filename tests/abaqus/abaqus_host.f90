module host_job
  !! What Abaqus' utility routines tell.
  implicit none (type, external)
  character(256) :: folder = '', name = ''
  integer :: notes = 0          !! messages that do not end the analysis
end module host_job

program abaqus_host
  !! abaqus_host FOLDER JOB: runs FOLDER/JOB.inp (of user elements alone) as Abaqus/Standard does: UEXTERNALDB once; Newton's
  !! method with UEL; state variables of the increment's start in every iteration; increments that PNEWDT or a missing
  !! convergence cuts. Prints, for each converged increment and each set of a *BOUNDARY, displacement (mean) and reaction (sum).
  use host_job, only: folder, name, notes
  use input_file, only: model_type, set_type, read_input, set_called
  implicit none (type, external)
  external :: uel, uexternaldb, dgesv
  integer, parameter :: both = 1, flags(3) = [1, 2, 5]     ! LFLAGS(3): both, stiffness, residual
  type(model_type) :: model
  type :: states_type
    real(8), allocatable :: n(:), now(:)
  end type states_type
  type(states_type), allocatable :: svars(:)
  real(8), allocatable :: u(:), u_n(:), at_start(:), target_u(:), force(:), k(:, :)
  logical, allocatable :: fixed(:), used(:)
  integer, allocatable :: sets(:)
  real(8) :: time, dt, pnewdt
  integer :: e, i, neq, step, increment, iterations, cuts

  call get_command_argument(1, folder)
  call get_command_argument(2, name)
  call read_input(trim(folder), trim(name)//'.inp', model)
  call uexternaldb(0, 0, [0d0, 0d0], 0d0, 0, 0)
  neq = model%ndm*size(model%x, 2)
  allocate (u(neq), u_n(neq), at_start(neq), target_u(neq), force(neq), source=0d0)
  allocate (k(neq, neq), fixed(neq), used(neq), sets(0), svars(size(model%elements)))
  used = .false.
  do e = 1, size(model%elements)
    used(dofs_of(e)) = .true.
    allocate (svars(e)%n(model%elements(e)%nsvars), source=0d0)
    svars(e)%now = svars(e)%n
  end do

  fixed = .false.
  increment = 0
  do step = 1, size(model%steps)
    call read_boundaries(step)
    if (.not. model%steps(step)%period > 0) cycle
    at_start = u
    time = 0
    dt = model%steps(step)%increment
    cuts = 0
    if (step > 0) call check_flags
    do while (time < model%steps(step)%period*(1 - 1d-12))
      dt = min(dt, model%steps(step)%period - time)
      u_n = u
      call solve_increment((time + dt)/model%steps(step)%period)
      if (pnewdt < 1) then
        u = u_n
        dt = dt*pnewdt
        cuts = cuts + 1
        if (cuts > 12) call give_up('too many cuts')
        cycle
      end if
      do e = 1, size(svars)
        svars(e)%n = svars(e)%now
      end do
      time = time + dt
      increment = increment + 1
      do i = 1, size(sets)
        call show(model%nsets(sets(i)))
      end do
      dt = model%steps(step)%increment
    end do
  end do
  print '(a,i0,a)', 'completed, ', notes, ' messages'

contains

  function dofs_of(e) result(dofs)
    integer, intent(in) :: e
    integer :: dofs(model%ndm*size(model%elements(e)%nodes))
    integer :: a, i

    do a = 1, size(model%elements(e)%nodes)
      do i = 1, model%ndm
        dofs(model%ndm*(a - 1) + i) = model%ndm*(model%elements(e)%nodes(a) - 1) + i
      end do
    end do
  end function dofs_of

  subroutine read_boundaries(step)
    integer, intent(in) :: step
    integer :: b, c, a, s

    if (step > 1) target_u = u
    if (step > 1) target_u = merge(target_u, 0d0, fixed)
    do b = 1, size(model%steps(step)%boundaries)
      associate (it => model%steps(step)%boundaries(b))
        s = set_called(model%nsets, it%set)
        if (.not. any(sets == s)) sets = [sets, s]
        do a = 1, size(model%nsets(s)%items)
          do c = it%first, it%last
            fixed(model%ndm*(model%nsets(s)%items(a) - 1) + c) = .true.
            target_u(model%ndm*(model%nsets(s)%items(a) - 1) + c) = it%value
          end do
        end do
      end associate
    end do
  end subroutine read_boundaries

  subroutine call_uel(e, flag, rhs, amatrx, states, energy)
    integer, intent(in) :: e, flag
    real(8), intent(inout) :: rhs(:, :), amatrx(:, :), states(:), energy(8)
    integer :: n, ndof, d(size(rhs, 1))
    real(8) :: v(size(rhs, 1)), coords(3, size(model%elements(e)%nodes)), predef(2, 1, size(model%elements(e)%nodes))

    n = size(model%elements(e)%nodes)
    ndof = model%ndm*n
    d = dofs_of(e)
    v = 0
    predef = 0
    coords = model%x(:, model%elements(e)%nodes)
    associate (it => model%elements(e))
      call uel(rhs, amatrx, states, energy, ndof, 1, size(states), it%props, size(it%props), coords, 3, n, u(d), &
               u(d) - u_n(d), v, v, it%type, [time, time], dt, step, increment, it%number, [0d0, 0d0, 0d0], 0, [0], [0d0], &
               predef, 1, [1, 1, flag, 0, 0], ndof, [0d0], 1, pnewdt, [0], 1, 1d0)
    end associate
  end subroutine call_uel

  subroutine assemble
    !! Force on the nodes (minus RHS) and stiffness.
    integer :: e, n
    real(8), allocatable :: rhs(:, :), amatrx(:, :)
    real(8) :: energy(8)

    force = 0
    k = 0
    do e = 1, size(model%elements)
      n = model%ndm*size(model%elements(e)%nodes)
      allocate (rhs(n, 1), amatrx(n, n), source=huge(1d0))
      svars(e)%now = svars(e)%n
      energy = 0
      call call_uel(e, both, rhs, amatrx, svars(e)%now, energy)
      if (pnewdt < 1) return
      associate (d => dofs_of(e))
        force(d) = force(d) - rhs(:, 1)
        k(d, d) = k(d, d) + amatrx
      end associate
      deallocate (rhs, amatrx)
    end do
  end subroutine assemble

  subroutine check_flags
    !! Stiffness alone and residual alone are those of both together, and leave the other list as it is.
    integer :: e, n
    real(8), allocatable :: rhs(:, :, :), amatrx(:, :, :)
    real(8) :: energy(8), untouched
    integer :: i

    untouched = huge(1d0)
    dt = model%steps(step)%increment
    pnewdt = 1
    do e = 1, size(model%elements)
      n = model%ndm*size(model%elements(e)%nodes)
      allocate (rhs(n, 1, 3), amatrx(n, n, 3), source=untouched)
      do i = 1, 3
        svars(e)%now = svars(e)%n
        call call_uel(e, flags(i), rhs(:, :, i), amatrx(:, :, i), svars(e)%now, energy)
      end do
      if (any(abs(amatrx(:, :, 1) - amatrx(:, :, 2)) > 0)) call give_up('LFLAGS(3) = 2 gives another stiffness than 1')
      if (any(abs(rhs(:, 1, 1) - rhs(:, 1, 3)) > 1d-12*maxval(abs(rhs(:, 1, 1))) + 1d-300)) &
        call give_up('LFLAGS(3) = 5 gives another residual than 1')
      if (any(amatrx(:, :, 3) < untouched) .or. any(rhs(:, :, 2) < untouched)) &
        call give_up('a list was touched that LFLAGS does not ask for')
      deallocate (rhs, amatrx)
    end do
  end subroutine check_flags

  subroutine solve_increment(part)
    !! From u_n to the boundary values at this part of the step; pnewdt < 1 if it fails.
    real(8), intent(in) :: part
    integer, allocatable :: free(:), pivots(:)
    real(8), allocatable :: a(:, :), b(:, :)
    real(8) :: du(neq)
    integer :: info, m

    free = pack([(m, m=1, neq)], used .and. .not. fixed)
    allocate (pivots(size(free)))
    pnewdt = 1
    do iterations = 1, 20
      call assemble
      if (pnewdt < 1) return
      du = 0
      where (fixed) du = at_start + part*(target_u - at_start) - u
      if (norm2(force(free)) <= 1d-11*norm2(pack(force, fixed)) + 1d-16 .and. norm2(du) <= 1d-14*(1 + norm2(u))) return
      b = reshape(-force(free) - matmul(k(free, :), du), [size(free), 1])
      a = k(free, free)
      call dgesv(size(free), 1, a, size(free), pivots, b, size(free), info)
      if (info /= 0) exit
      u = u + du
      u(free) = u(free) + b(:, 1)
    end do
    pnewdt = 0.25d0
  end subroutine solve_increment

  subroutine show(set)
    type(set_type), intent(in) :: set
    integer :: c

    associate (first => model%ndm*(set%items - 1))
      print '(i5,1x,f10.5,1x,a,*(1x,es23.15))', increment, time, trim(set%name), &
        [(sum(u(first + c))/size(set%items), c=1, model%ndm)], [(sum(force(first + c)), c=1, model%ndm)]
    end associate
  end subroutine show

  subroutine give_up(text)
    character(*), intent(in) :: text

    print '(a)', 'host: '//text
    stop 1, quiet=.true.
  end subroutine give_up
end program abaqus_host

subroutine getoutdir(outdir, length)
  use host_job, only: folder
  implicit none (type, external)
  character(256), intent(out) :: outdir
  integer, intent(out) :: length

  outdir = folder
  length = len_trim(folder)
end subroutine getoutdir

subroutine getjobname(jobname, length)
  use host_job, only: name
  implicit none (type, external)
  character(256), intent(out) :: jobname
  integer, intent(out) :: length

  jobname = name
  length = len_trim(name)
end subroutine getjobname

subroutine stdb_abqerr(lop, string, intv, realv, charv)
  !! Prints the text with %I replaced by the numbers; -3 ends the analysis.
  use host_job, only: notes
  implicit none (type, external)
  integer, intent(in) :: lop, intv(*)
  character(500), intent(in) :: string
  real(8), intent(in) :: realv(*)
  character(8), intent(in) :: charv(*)
  external :: xit
  character(600) :: text
  character(12) :: digits
  integer :: i, n

  text = string
  n = 0
  do
    i = index(text, '%I')
    if (i == 0) exit
    n = n + 1
    write (digits, '(i0)') intv(n)
    text = text(1:i - 1)//trim(digits)//text(i + 2:)
  end do
  associate (u1 => realv(1:0), u2 => charv(1:0))
  end associate
  print '(a)', trim(merge('***ERROR: ', '***NOTE:  ', lop == -3)//text)
  notes = notes + 1
  if (lop == -3) call xit
end subroutine stdb_abqerr

subroutine xit
  implicit none (type, external)
  stop 1, quiet=.true.
end subroutine xit
