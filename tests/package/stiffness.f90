program stiffness
  !! Stiffness of a bilinear unit square in plane stress, E = 1, nu = 0.3, row by row, through the element interface.
  use kinds, only: wp
  use status_codes, only: ok
  use user_element, only: element_geometry, element_state, element_energy, task_prepare, task_tangent, mirror
  use material_laws, only: define_solid_law, small_strain, plane_stress
  use solid_element, only: solid_element_type
  implicit none (type, external)
  type(solid_element_type) :: element
  type(element_geometry) :: geo
  type(element_state) :: state
  type(element_energy) :: energy
  real(wp), target :: xe(2, 4), we(4), ce(4, 4), ue(2, 4)
  real(wp), target, allocatable :: table(:)
  real(wp) :: fe(2, 4), ke(2, 4, 2, 4), square(8, 8)
  integer :: i, nhist, ntable, status

  element%ndm = 2
  element%ndf = 2
  call define_solid_law(small_strain, plane_stress, 1.0_wp, 0.3_wp, element%law, status)
  if (status /= ok) error stop 1
  xe = reshape([0, 0, 1, 0, 0, 1, 1, 1], [2, 4])
  we = 1
  ce = 0
  do i = 1, 4
    ce(i, i) = 1
  end do
  ue = 0
  geo%ndm = 2
  geo%dp = 2
  geo%nen = 4
  geo%degree(1:2) = 1
  geo%xe => xe
  geo%we => we
  geo%ce => ce
  state%ue => ue
  call element%sizes(geo, ntable, nhist)
  allocate (table(ntable))
  geo%table => table
  call element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
  if (status == ok) call element%evaluate(task_tangent, geo, state, fe, ke, energy, status)
  if (status /= ok) error stop 1
  call mirror(ke)
  square = reshape(ke, [8, 8])
  do i = 1, 8
    print '(7(f0.12,1x),f0.12)', square(i, :)
  end do
end program stiffness
