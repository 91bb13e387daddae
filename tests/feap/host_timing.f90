module host_timing
  !! What a call of the solid through elmt01 costs against the kernel alone, on the first element of a deck.
  use user_element, only: element_geometry, element_state, element_energy, property_record, task_prepare, task_tangent, &
    task_residual
  use solid_element, only: solid_element_type
  use feap_mesh, only: mesh, weights_of
  use host_mesh, only: call_element
  implicit none
  private
  public :: time_calls

contains

  subroutine time_calls()
    include 'cdata.h'
    include 'sdata.h'
    include 'eldata.h'
    include 'pointer.h'
    include 'comblk.h'
    integer, parameter :: rounds = 15
    real(8), target :: xl(ndm, nen), ul(ndf, nen, 7), we(nen), s(nst*nst), p(nst)
    real(8), target :: fe(ndf, nen), ke(ndf, nen, ndf, nen)
    real(8), target, allocatable :: table(:)
    real(8) :: tl(nen), d(10), best(2, 2), start, finish
    integer :: calls, ix(nen), i, j, k, round, task, nt, nhist, status, bad
    character(:), allocatable :: fault
    type(solid_element_type) :: solid
    type(property_record) :: line(1)
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    external :: elmt01

    calls = max(200, nint(20000*(16.0/nen)**2))
    nel = nen
    n_el = 1
    ma = mr(np(33) + nen1 - 1)
    ix = mr(np(33):np(33) + nen - 1)
    do i = 1, nen
      do j = 1, ndm
        xl(j, i) = hr(np(43) + ndm*(ix(i) - 1) + j - 1)
      end do
    end do
    do i = 1, nen
      do j = 1, ndm
        ul(j, i, :) = 0.01d0*sin(real(7*i + 3*j, 8))*maxval(abs(xl(:, 1) - xl(:, nen)))
      end do
    end do
    tl = 0
    d = 0
    call call_element(1, d, ul, xl, ix, tl, s, p, ndf, ndm, nst, 14)

    line(1)%place = ''
    line(1)%words = ['elas', 'neoh']
    line(1)%values = [1.0d0, 0.3d0]
    call solid%define(ndm, line, fault, bad)
    geo%ndm = ndm
    geo%dp = ndm
    geo%nen = nen
    geo%degree = mesh%degree(:, 1)
    geo%ce => mesh%operator(1)
    geo%xe => xl
    call weights_of(mesh%connectivity(1), we)
    geo%we => we
    call solid%sizes(geo, nt, nhist)
    allocate (table(nt))
    geo%table => table
    state%ue => ul(:, :, 1)
    state%un => ul(:, :, 1)
    call solid%evaluate(task_prepare, geo, state, fe, ke, energy, status)

    best = huge(best)
    do round = 1, rounds
      do task = 1, 2
        call cpu_time(start)
        do k = 1, calls
          call solid%evaluate(merge(task_tangent, task_residual, task == 1), geo, state, fe, ke, energy, status)
        end do
        call cpu_time(finish)
        best(1, task) = min(best(1, task), (finish - start)/calls)
        call cpu_time(start)
        do k = 1, calls
          call elmt01(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, merge(3, 6, task == 1))
        end do
        call cpu_time(finish)
        best(2, task) = min(best(2, task), (finish - start)/calls)
      end do
    end do
    if (status /= 0 .or. abs(s(1) - ke(1, 1, 1, 1)) > 1e-12*abs(s(1))) error stop 'host: kernel and adapter differ'
    print '(a,i0,a,3(i0,1x))', 'functions ', nen, ', degrees ', mesh%degree(:, 1)
    print '(a,2f9.3,f8.1)', 'tangent:  kernel, elmt01 [us], more [%] ', 1e6*best(:, 1), 100*(best(2, 1)/best(1, 1) - 1)
    print '(a,2f9.3,f8.1)', 'residual: kernel, elmt01 [us], more [%] ', 1e6*best(:, 2), 100*(best(2, 2)/best(1, 2) - 1)
  end subroutine time_calls
end module host_timing
