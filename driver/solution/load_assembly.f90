module load_assembly
  !! The loads of a model: nodal forces, dead tractions and pressures, body forces (integrated once), follower
  !! pressures and moments on edges (integrated in every assembly, with their unsymmetric tangent). Each scales with its time function.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type, surface_load_type
  use dof_map, only: prescribed_factor, prescribed_rate
  use facets, only: facet_surface, build_facets
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use surface_load, only: dead_traction, dead_pressure, follower_pressure, body_force
  use edge_moments, only: edge_moment_type, prepare_edge_moment, add_edge_moment
  use bulk_elements, only: add_moved_force
  use equation_system, only: equation_system_type
  implicit none (type, external)
  private
  public :: load_points_type, prepare_loads, assemble_loads, load_rates, loads_are_symmetric

  type :: dead_load
    real(wp), allocatable :: force(:, :)   !! load at factor 1 (ndf,nn) [force]
    integer :: prop = 0
  end type dead_load

  type :: follower_load
    type(facet_surface) :: surface
    real(wp) :: pressure = 0               !! at factor 1 [stress]
    integer :: prop = 0
    integer :: gp = 0
  end type follower_load

  type :: load_points_type
    type(dead_load), allocatable :: dead(:)
    type(follower_load), allocatable :: follower(:)
    type(edge_moment_type), allocatable :: moments(:)
  end type load_points_type

contains

  pure function loads_are_symmetric(model) result(symmetric)
    type(model_type), intent(in) :: model
    logical :: symmetric

    symmetric = .true.
    if (allocated(model%loads)) symmetric = .not. any(model%loads%kind == 'follower' .or. model%loads%kind == 'moment')
  end function loads_are_symmetric

  subroutine prepare_loads(model, loads)
    !! Integrate the dead loads; find the facets of the follower loads.
    type(model_type), intent(in), target :: model
    type(load_points_type), intent(out) :: loads
    integer :: l, n
    type(facet_surface) :: surface
    type(edge_moment_type) :: moment

    allocate (loads%dead(0), loads%follower(0), loads%moments(0))
    n = 0
    if (allocated(model%loads)) n = size(model%loads)
    do l = 1, n
      associate (load => model%loads(l))
        select case (load%kind)
        case ('follower')
          call build_facets(model, load%set, surface)
          loads%follower = [loads%follower, follower_load(surface, load%value(1), load%prop, load%gp)]
        case ('moment')
          call prepare_edge_moment(model, load, moment)
          loads%moments = [loads%moments, moment]
        case ('body')
          loads%dead = [loads%dead, dead_load(body_vector(model, load), load%prop)]
        case default
          call build_facets(model, load%set, surface)
          loads%dead = [loads%dead, dead_load(surface_vector(model, load, surface), load%prop)]
        end select
      end associate
    end do
  end subroutine prepare_loads

  function surface_vector(model, load, surface) result(force)
    !! A dead traction or pressure as nodal forces.
    type(model_type), intent(in) :: model
    type(surface_load_type), intent(in) :: load
    type(facet_surface), intent(in), target :: surface
    real(wp), allocatable :: force(:, :), shp(:, :), dshp(:, :, :), wt(:), fe(:, :), value(:, :)
    integer, pointer, contiguous :: nodes(:)
    integer :: f, a, g

    allocate (force(model%ndf, model%nn), source=0.0_wp)
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      call facet_points(model, surface, f, load%gp, shp, dshp, wt)
      allocate (fe(model%ndm, size(nodes)))
      if (load%kind == 'pressure') then
        call dead_pressure(model%x(:, nodes), shp, dshp, wt, [(load%value(1), g=1, size(wt))], fe)
      else
        value = spread(load%value(1:model%ndm), 2, size(wt))
        call dead_traction(model%x(:, nodes), shp, dshp, wt, value, fe)
      end if
      do a = 1, size(nodes)
        force(1:model%ndm, nodes(a)) = force(1:model%ndm, nodes(a)) - fe(:, a)
      end do
      deallocate (fe)
    end do
  end function surface_vector

  function body_vector(model, load) result(force)
    !! A body force as nodal forces.
    type(model_type), intent(in), target :: model
    type(surface_load_type), intent(in) :: load
    real(wp), allocatable :: force(:, :), xi(:, :), wt(:), shp(:, :), dshp(:, :), dx(:, :), dvol(:), fe(:, :)
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: d2shp(0, 0), detj
    integer :: i, e, a, g, n, status, rule(model%ndm)

    allocate (force(model%ndf, model%nn), source=0.0_wp)
    do i = 1, size(model%sets(load%set)%items)
      e = model%sets(load%set)%items(i)
      nodes => model%mesh%connectivity(e)
      n = size(nodes)
      rule = model%mesh%degree(1:model%ndm, e) + 1
      if (load%gp > 0) rule = load%gp
      allocate (xi(model%ndm, product(rule)), wt(product(rule)), shp(n, product(rule)), dshp(model%ndm, n), &
        dx(model%ndm, n), dvol(product(rule)), fe(model%ndm, n))
      call tensor_rule(rule, xi, wt)
      do g = 1, size(wt)
        call shape_functions(model%mesh%degree(1:model%ndm, e), model%w(nodes), model%mesh%operator(e), xi(:, g), 1, &
                             shp(:, g), dshp, d2shp, status)
        call physical_gradient(model%x(:, nodes), dshp, dx, detj, status)
        dvol(g) = wt(g)*detj
      end do
      call body_force(shp, dvol, spread(load%value(1:model%ndm), 2, size(wt)), fe)
      do a = 1, n
        force(1:model%ndm, nodes(a)) = force(1:model%ndm, nodes(a)) - fe(:, a)
      end do
      deallocate (xi, wt, shp, dshp, dx, dvol, fe)
    end do
  end function body_vector

  subroutine facet_points(model, surface, f, gp, shp, dshp, wt)
    !! Functions of a facet at the points of its rule.
    type(model_type), intent(in) :: model
    type(facet_surface), intent(in), target :: surface
    integer, intent(in) :: f
    integer, intent(in) :: gp               !! points per direction, 0: degree + 1
    real(wp), allocatable, intent(out) :: shp(:, :), dshp(:, :, :), wt(:)
    integer, pointer, contiguous :: nodes(:)
    real(wp), allocatable :: xi(:, :)
    real(wp) :: d2shp(0, 0)
    integer :: dp, g, status, rule(surface%set%dp(f))

    dp = surface%set%dp(f)
    nodes => surface%set%connectivity(f)
    rule = surface%set%degree(1:dp, f) + 1
    if (gp > 0) rule = gp
    allocate (xi(dp, product(rule)), wt(product(rule)), shp(size(nodes), product(rule)))
    allocate (dshp(dp, size(nodes), product(rule)))
    call tensor_rule(rule, xi, wt)
    do g = 1, size(wt)
      call shape_functions(surface%set%degree(1:dp, f), model%w(nodes), surface%set%operator(f), xi(:, g), 1, &
                           shp(:, g), dshp(:, :, g), d2shp, status)
    end do
  end subroutine facet_points

  subroutine assemble_loads(model, loads, time, u, du, moves, want_tangent, system, fext, f, f_moved, status)
    !! fext := all loads at a time, f := f - fext; in task_tangent the follower loads' change by du goes to f_moved.
    type(model_type), intent(in) :: model
    type(load_points_type), intent(in), target :: loads
    real(wp), intent(in) :: time
    real(wp), intent(in) :: u(:, :), du(:, :)
    logical, intent(in) :: moves(:)
    logical, intent(in) :: want_tangent
    type(equation_system_type), intent(inout) :: system
    real(wp), intent(out) :: fext(:, :)
    real(wp), intent(inout) :: f(:, :), f_moved(:, :)
    integer, intent(out) :: status
    integer, pointer, contiguous :: nodes(:)
    real(wp), allocatable :: shp(:, :), dshp(:, :, :), wt(:), fe(:, :), ke(:, :, :, :)
    integer :: a, i, l, g, k, n
    real(wp) :: factor

    status = ok
    fext = 0
    if (allocated(model%force)) then
      do a = 1, size(model%force, 2)
        do i = 1, model%ndf
          if (abs(model%force(i, a)) > 0) fext(i, a) = model%force(i, a) &
            *prescribed_factor(model%props, model%force_prop(i, a), time)
        end do
      end do
    end if
    do l = 1, size(loads%dead)
      fext(:, 1:model%nn) = fext(:, 1:model%nn) &
        + prescribed_factor(model%props, loads%dead(l)%prop, time)*loads%dead(l)%force
    end do
    f = f - fext
    do l = 1, size(loads%follower)
      factor = loads%follower(l)%pressure*prescribed_factor(model%props, loads%follower(l)%prop, time)
      do k = 1, loads%follower(l)%surface%set%ne
        nodes => loads%follower(l)%surface%set%connectivity(k)
        n = size(nodes)
        call facet_points(model, loads%follower(l)%surface, k, loads%follower(l)%gp, shp, dshp, wt)
        allocate (fe(model%ndm, n), ke(model%ndm, n, model%ndm, n))
        call follower_pressure(model%x(:, nodes), u(1:model%ndm, nodes), shp, dshp, wt, &
                               [(factor, g=1, size(wt))], fe, ke)
        if (want_tangent) then
          if (size(moves) > 0) then
            if (any(moves(nodes))) call add_moved_force(ke, du, nodes, .false., f_moved)
          end if
          call system%add_loose(nodes, ke, .false.)
        end if
        do a = 1, n
          fext(1:model%ndm, nodes(a)) = fext(1:model%ndm, nodes(a)) - fe(:, a)
          f(1:model%ndm, nodes(a)) = f(1:model%ndm, nodes(a)) + fe(:, a)
        end do
        deallocate (fe, ke)
      end do
    end do
    do l = 1, size(loads%moments)
      factor = prescribed_factor(model%props, loads%moments(l)%prop, time)
      f = f + fext
      if (want_tangent) then
        call add_edge_moment(model, loads%moments(l), factor, u, fext, status, du, moves, system, f_moved)
      else
        call add_edge_moment(model, loads%moments(l), factor, u, fext, status)
      end if
      f = f - fext
      if (status /= ok) return
    end do
  end subroutine assemble_loads

  subroutine load_rates(model, loads, time, u, rate)
    !! d fext / d time at standing control values u, for path following.
    type(model_type), intent(in) :: model
    type(load_points_type), intent(in), target :: loads
    real(wp), intent(in) :: time
    real(wp), intent(in) :: u(:, :)
    real(wp), intent(out) :: rate(:, :)      !! (ndf,nn) [force/time]
    integer, pointer, contiguous :: nodes(:)
    real(wp), allocatable :: shp(:, :), dshp(:, :, :), wt(:), fe(:, :), ke(:, :, :, :)
    real(wp) :: factor
    integer :: a, i, l, k, g, status

    rate = 0
    if (allocated(model%force)) then
      do a = 1, size(model%force, 2)
        do i = 1, model%ndf
          if (abs(model%force(i, a)) > 0) rate(i, a) = model%force(i, a) &
            *prescribed_rate(model%props, model%force_prop(i, a), time)
        end do
      end do
    end if
    do l = 1, size(loads%dead)
      factor = prescribed_rate(model%props, loads%dead(l)%prop, time)
      rate(:, 1:model%nn) = rate(:, 1:model%nn) + factor*loads%dead(l)%force
    end do
    do l = 1, size(loads%follower)
      factor = loads%follower(l)%pressure*prescribed_rate(model%props, loads%follower(l)%prop, time)
      do k = 1, loads%follower(l)%surface%set%ne
        nodes => loads%follower(l)%surface%set%connectivity(k)
        call facet_points(model, loads%follower(l)%surface, k, loads%follower(l)%gp, shp, dshp, wt)
        allocate (fe(model%ndm, size(nodes)), ke(model%ndm, size(nodes), model%ndm, size(nodes)))
        call follower_pressure(model%x(:, nodes), u(1:model%ndm, nodes), shp, dshp, wt, [(factor, g=1, size(wt))], fe, ke)
        do a = 1, size(nodes)
          rate(1:model%ndm, nodes(a)) = rate(1:model%ndm, nodes(a)) - fe(:, a)
        end do
        deallocate (fe, ke)
      end do
    end do
    do l = 1, size(loads%moments)
      factor = prescribed_rate(model%props, loads%moments(l)%prop, time)
      call add_edge_moment(model, loads%moments(l), factor, u, rate, status)
    end do
  end subroutine load_rates
end module load_assembly
