module adapter_benchmarks
  !! An element through the adapters of hosts against the kernel alone: neo-Hookean, p + 1 Gauss points a direction.
  use kinds, only: wp
  use c_solids, only: c_solid_law, bezel_define_solid_law, bezel_solid_tangent
  use status_codes, only: ok
  use solid_samples, only: element, distorted_element, wave
  use material_laws, only: solid_law, define_solid_law, neo_hooke, plane_strain, three_dimensional
  use solid_kernel, only: solid_tangent
  use symmetric_tangent, only: mirror
  use extraction_mesh, only: extraction_mesh_type
  use iga_writer, only: write_iga
  use stopwatch, only: stopwatch_type
  use report, only: put, text
  implicit none (type, external)
  private
  public :: measure_adapters
  character(256), public :: job_folder = ''

  interface
    subroutine uel(rhs, amatrx, svars, energy, ndofel, nrhs, nsvars, props, nprops, coords, mcrd, nnode, u, du, v, a, &
        jtype, time, dtime, kstep, kinc, jelem, params, ndload, jdltyp, adlmag, predef, npredf, lflags, mlvarx, ddlmag, &
        mdload, pnewdt, jprops, njprop, period)
      implicit none (type, external)
      integer, intent(in) :: ndofel, nrhs, nsvars, nprops, mcrd, nnode, jtype, kstep, kinc, jelem, ndload, npredf, &
        mlvarx, mdload, njprop
      real(8), intent(inout) :: rhs(mlvarx, *), amatrx(ndofel, ndofel), svars(nsvars), energy(8), pnewdt
      real(8), intent(in) :: props(nprops), coords(mcrd, nnode), u(ndofel), du(mlvarx, *), v(ndofel), a(ndofel), time(2), &
        dtime, params(*), adlmag(mdload, *), predef(2, npredf, nnode), ddlmag(mdload, *), period
      integer, intent(in) :: jdltyp(mdload, *), lflags(*), jprops(*)
    end subroutine uel

    subroutine uexternaldb(lop, lrestart, time, dtime, kstep, kinc)
      implicit none (type, external)
      integer, intent(in) :: lop, lrestart, kstep, kinc
      real(8), intent(in) :: time(2), dtime
    end subroutine uexternaldb
  end interface

contains

  subroutine measure_adapters(scratch, ndm, p)
    character(*), intent(in) :: scratch          !! folder
    integer, intent(in) :: ndm, p
    type(element) :: sample
    type(solid_law) :: law
    type(c_solid_law) :: c_law
    type(stopwatch_type) :: watch
    real(wp), allocatable :: ue(:, :), fe(:, :), ke(:, :, :, :), rhs(:, :), amatrx(:, :), du(:), predef(:, :, :)
    real(wp) :: energy, energies(8), svars(1), pnewdt, kernel, times(3)
    integer :: a, i, n, nen, status, mode, pass
    character(:), allocatable :: row

    row = text(ndm)//'D p = '//text(p)
    mode = merge(plane_strain, three_dimensional, ndm == 2)
    sample = distorted_element(ndm, p, p + 1)
    nen = size(sample%we)
    n = ndm*nen
    call write_job(scratch, ndm, sample)
    call uexternaldb(0, 0, [0.0_wp, 0.0_wp], 0.0_wp, 0, 0)
    call define_solid_law(neo_hooke, mode, 1.0_wp, 0.3_wp, law, status)
    status = bezel_define_solid_law(neo_hooke, mode, 1.0_wp, 0.3_wp, c_law)
    allocate (ue(ndm, nen), fe(ndm, nen), ke(ndm, nen, ndm, nen), rhs(n, 1), amatrx(n, n), du(n), predef(2, 1, nen))
    du = 0
    predef = 0
    svars = 0
    pnewdt = 1
    do a = 1, nen
      do i = 1, ndm
        ue(i, a) = 0.02_wp*wave(a, 5*i)/p
      end do
    end do
    times = huge(kernel)
    kernel = huge(kernel)
    do pass = 1, 5                               ! turn by turn: all see the same state of the machine
      call watch%begin()
      do while (watch%goes_on())
        call solid_tangent(sample%dshp, sample%dvol, ue, law, fe, ke, energy, status)
      end do
      kernel = min(kernel, watch%best)
      call watch%begin()
      do while (watch%goes_on())
        call solid_tangent(sample%dshp, sample%dvol, ue, law, fe, ke, energy, status)
        call mirror(ke)
      end do
      times(1) = min(times(1), watch%best)
      call watch%begin()
      do while (watch%goes_on())
        status = bezel_solid_tangent(ndm, nen, (p + 1)**ndm, sample%dshp, sample%dvol, ue, c_law, fe, ke, energy)
      end do
      times(2) = min(times(2), watch%best)
      call watch%begin()
      do while (watch%goes_on())
        call uel(rhs, amatrx, svars, energies, n, 1, 1, [1.0_wp, 1.0_wp, 0.3_wp, real(mode, wp), 0.0_wp], 5, sample%xe, ndm, &
                 nen, ue, du, du, du, 1000 + nen, [0.0_wp, 0.0_wp], 1.0_wp, 1, 1, 1, [0.0_wp], 0, [0], [0.0_wp], predef, 1, &
                 [1, 1, 1, 0, 0], n, [0.0_wp], 1, pnewdt, [0], 1, 1.0_wp)
      end do
      times(3) = min(times(3), watch%best)
    end do
    if (status /= ok .or. pnewdt < 1) error stop 'adapter_benchmarks: the sample fails'
    if (any(abs(rhs(:, 1) + reshape(fe, [n])) > 1.0e-13_wp)) error stop 'adapter_benchmarks: UEL gives another force'
    call put('adapter', row, 'kernel [us]', 1.0e6_wp*kernel)
    call put('adapter', row, 'with both triangles [us]', 1.0e6_wp*times(1))
    call put('adapter', row, 'through C [us]', 1.0e6_wp*times(2))
    call put('adapter', row, 'through UEL, both triangles [us]', 1.0e6_wp*times(3))
    call put('adapter', row, 'more through C [%]', 100*(times(2)/kernel - 1))
    call put('adapter', row, 'more through UEL [%]', 100*(times(3)/kernel - 1))
  end subroutine measure_adapters

  subroutine write_job(scratch, ndm, sample)
    !! JOB.bezel and its mesh of one element.
    character(*), intent(in) :: scratch
    integer, intent(in) :: ndm
    type(element), intent(in) :: sample
    type(extraction_mesh_type) :: mesh
    character(:), allocatable :: lines
    real(wp) :: x(3)
    integer :: a, unit

    call mesh%start('')
    do a = 1, size(sample%we)
      x = 0
      x(1:ndm) = sample%xe(:, a)
      call mesh%add_node(x, sample%we(a), 0)
    end do
    call mesh%add_element(sample%degree, [(a, a=1, size(sample%we))], sample%ce, 0)
    call mesh%finish()
    call write_iga(mesh, ndm, lines)
    job_folder = scratch
    open (newunit=unit, file=scratch//'/benchmark.iga', action='write', access='stream', status='replace')
    write (unit) lines
    close (unit)
    open (newunit=unit, file=scratch//'/benchmark.bezel', action='write', status='replace')
    write (unit, '(a)') 'MESH FILE=benchmark.iga', 'SOLID FIRST=1'
    close (unit)
  end subroutine write_job
end module adapter_benchmarks
