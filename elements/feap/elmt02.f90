subroutine elmt02(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
  !! One Gauss point of an interface, contact or cohesive: MATErial, then GPTS and the lines of `gpts_element`:
  !! PENAlty e, COHEsive ..., REVErsible. Elements of this material are made by CONTact. History of a cohesive point:
  !! nh1, nh2 hold its largest opening and that at the start.
  use kinds, only: wp
  use user_element, only: element_energy, task_residual, task_tangent
  use gpts_element, only: gpts_element_type
  use feap_materials, only: define_material
  use feap_arrays, only: positions
  use feap_contact, only: begin_interfaces, point_forces, history_size, first_history, note_history, point_range, interface_count
  implicit none
  integer, intent(in) :: ndf, ndm, nst, isw
  integer, intent(inout) :: ix(*)
  real(wp), intent(in) :: d(*), ul(ndf, *), tl(*)
  real(wp), intent(in), target :: xl(ndm, *)
  real(wp), intent(inout) :: s(*), p(*)
  include 'eldata.h'
  include 'hdata.h'
  include 'comblk.h'
  include 'umac1.h'
  include 'ptdat6.h'
  integer, parameter :: tangent = 3, print_state = 4, residual = 6, accept_step = 12, energy_task = 13, start = 14
  type(gpts_element_type) :: gpts
  type(element_energy) :: energy
  real(wp), allocatable :: x_ref(:, :), x(:, :), hist(:)
  integer :: i, nt, nhist, first, last

  if (isw < 0) then
    utx(1) = 'gpts'
    return
  else if (isw == 1) then
    call define_material(ma, gpts, ndm)
    do i = ndm + 1, ndf
      ix(i) = 0
    end do
    call history_size(ma, nt, nhist)
    nh1 = nhist
    pstyp = 0
    return
  end if

  call history_size(ma, nt, nhist)
  allocate (hist(nhist))
  select case (isw)
  case (start)
    first = 0
    if (interface_count() > 0) call point_range(1, first, last)
    if (n_el == first) then
      call positions(x_ref, x)
      call begin_interfaces(x_ref)
    end if
    call first_history(n_el, ma, hist)
    do i = 1, nhist
      hr(nh1 + i - 1) = hist(i)
      hr(nh2 + i - 1) = hist(i)
    end do
  case (tangent, residual)
    call point_forces(n_el, ma, merge(task_tangent, task_residual, isw == tangent), ndf, ndm, nel, nst, xl, ul, &
      hr(nh1:nh1 + nhist - 1), hist, s, p, energy)
    do i = 1, nhist
      hr(nh2 + i - 1) = hist(i)
    end do
  case (print_state, energy_task)
    call point_forces(n_el, ma, task_residual, ndf, ndm, nel, nst, xl, ul, hr(nh1:nh1 + nhist - 1), hist, s, p, &
      energy)
    if (isw == energy_task) epl(8) = epl(8) + energy%stored + energy%penalty
    if (isw == print_state) call print_point()
  case (accept_step)
    if (nhist > 0) call note_history(n_el, ma, hr(nh2:nh2 + nhist - 1))
  end select

contains

  subroutine print_point()
    include 'bdata.h'
    include 'iofile.h'

    mct = mct - 1
    if (mct <= 0) then
      write (iow, '(a1,20a4//5x,a//a)') o, head, 'Interface Points', &
        '    Elmt Mat         gap    traction     opening at the start'
      mct = 50
    end if
    write (iow, '(i8,i4,1p,4e12.4)') n_el, ma, energy%gap, energy%traction, hist
  end subroutine print_point
end subroutine elmt02
