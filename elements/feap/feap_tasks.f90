module feap_tasks
  !! FEAP's tasks for elements of bodies and surfaces, once their material is defined.
  !!
  !! The elmtNN know it by its binding name, without `use`: an external procedure that uses modules with ieee_arithmetic in
  !! reach saves and restores the floating-point state in each call (gfortran), which costs as much as a small element.
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use kinds, only: wp
  use feap_bulk, only: prepare_element, element_forces, stress_at_points
  implicit none
  private
  public :: bulk_tasks

contains

  subroutine bulk_tasks(ul, xl, s, p, ndf, ndm, nst, isw) bind(c, name='bezel_feap_bulk_tasks')
    !! Those that are not named need nothing: such an element has no history of its own.
    integer(c_int), intent(in) :: ndf, ndm, nst, isw
    real(c_double), intent(in) :: ul(ndf, *)
    real(c_double), intent(in), target :: xl(ndm, *)
    real(c_double), intent(inout) :: s(*), p(*)
    include 'cdata.h'
    include 'eldata.h'
    include 'ptdat6.h'
    integer, parameter :: check_mesh = 2, tangent = 3, print_stress = 4, residual = 6, project_stress = 8, &
      energy_task = 13, start = 14
    real(wp) :: energy
    real(wp), allocatable :: x(:, :), shp(:, :), dvol(:), stress(:, :)

    select case (isw)
    case (check_mesh, start)
      call prepare_element(n_el, ma, ndm, nel, xl, numel)
    case (tangent, residual)
      call element_forces(n_el, ma, isw == tangent, ndf, ndm, nel, nst, xl, ul, s, p, energy)
    case (energy_task)
      call element_forces(n_el, ma, .false., ndf, ndm, nel, nst, xl, ul, s, p, energy)
      epl(8) = epl(8) + energy
    case (print_stress, project_stress)
      call stress_at_points(n_el, ma, ndf, ndm, nel, xl, ul, x, shp, dvol, stress)
      if (isw == print_stress) call print_stresses()
      if (isw == project_stress) call project(s, p)
    end select

  contains

    subroutine print_stresses()
      include 'bdata.h'
      include 'iofile.h'
      integer :: g

      do g = 1, size(dvol)
        mct = mct - 2
        if (mct <= 0) then
          write (iow, '(a1,20a4//5x,a//a/a)') o, head, 'Element Stresses', &
            '    Elmt Mat    1-coord    2-coord    3-coord', &
            '             11-stress   22-stress   33-stress   12-stress   23-stress   31-stress'
          mct = 50
        end if
        write (iow, '(i8,i4,1p,3e11.3/10x,6e12.4)') n_el, ma, x(:, g), spread(0.0_wp, 1, 3 - ndm), &
          stress(1:min(6, size(stress, 1)), g)
      end do
    end subroutine print_stresses

    subroutine project(integral, weight)
      !! Lumped projection to the nodes.
      real(wp), intent(inout) :: integral(nen, *)   !! of R_a stress
      real(wp), intent(inout) :: weight(*)          !! of R_a; behind them FEAP's error indicator
      include 'prstrs.h'
      include 'strnum.h'
      integer :: a, g, k

      do g = 1, size(dvol)
        do a = 1, nel
          weight(a) = weight(a) + shp(a, g)*dvol(g)
          weight(nen + a) = weight(nen + a) + erav*shp(a, g)*dvol(g)
          do k = 1, min(6, size(stress, 1))
            integral(a, k) = integral(a, k) + stress(k, g)*shp(a, g)*dvol(g)
          end do
        end do
      end do
      iste = 6
    end subroutine project
  end subroutine bulk_tasks
end module feap_tasks
