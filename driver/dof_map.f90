module dof_map
  !! From control values to equations. A control value is free, prescribed, or a linear function of others (LINK).
  !! Equations are numbered node by node; globals (a face rotation, a load factor) would follow them.
  use kinds, only: wp
  use model_data, only: model_type, time_function
  implicit none (type, external)
  private
  public :: dof_map_type, build_dof_map, prescribed_factor, prescribed_rate, is_prescribed, is_linked

  integer, parameter :: is_prescribed = 0  !! value of `eq` for a prescribed dof; a linked dof k has eq = -k
  type :: linked_dof
    integer :: node = 0, comp = 0
    integer, allocatable :: nodes(:), comps(:)  !! the dofs it depends on, none of them linked itself
    real(wp), allocatable :: coefs(:)
    real(wp) :: constant = 0
  end type linked_dof

  type :: dof_map_type
    integer :: ndf = 0, nn = 0, neq = 0
    integer, allocatable :: eq(:, :)        !! (ndf,nn): > 0 equation, 0 prescribed, -k linked dof k
    integer, allocatable :: first(:)        !! (nn) first equation of a node
    integer, allocatable :: count(:)        !! (nn) its free components
    logical, allocatable :: has_link(:)     !! (nn) some component is linked
    type(linked_dof), allocatable :: links(:)
  contains
    procedure :: expand
    procedure :: reduce
    procedure :: add_increment
    procedure :: follow
    procedure :: rates
    procedure :: spread_increment
  end type dof_map_type

contains

  elemental function is_linked(eq) result(yes)
    integer, intent(in) :: eq
    logical :: yes
    yes = eq < 0
  end function is_linked

  subroutine build_dof_map(model, map)
    !! Number the free dofs. Chains of links were resolved by the deck's check: masters are not linked themselves.
    type(model_type), intent(in) :: model
    type(dof_map_type), intent(out) :: map
    integer :: a, i, l

    map%ndf = model%ndf
    map%nn = model%nn
    allocate (map%eq(map%ndf, map%nn), map%first(map%nn), map%count(map%nn), map%has_link(map%nn))
    map%eq = 1
    where (model%fixed) map%eq = is_prescribed
    map%has_link = .false.
    if (allocated(model%links)) then
      allocate (map%links(size(model%links)))
      do l = 1, size(model%links)
        associate (from => model%links(l))
          map%links(l) = linked_dof(from%node, from%comp, from%nodes, from%comps, from%coefs, from%constant)
          map%eq(from%comp, from%node) = -l
          map%has_link(from%node) = .true.
        end associate
      end do
    else
      allocate (map%links(0))
    end if
    map%neq = 0
    do a = 1, map%nn
      map%first(a) = map%neq + 1
      map%count(a) = 0
      do i = 1, map%ndf
        if (map%eq(i, a) /= 1) cycle
        map%neq = map%neq + 1
        map%eq(i, a) = map%neq
        map%count(a) = map%count(a) + 1
      end do
    end do
  end subroutine build_dof_map

  pure function prescribed_factor(props, number, time) result(factor)
    !! Factor of a prescribed value or load: its time function, or, with number 0, the sum of all time functions
    !! (FEAP's proportional load), or 1 where the deck has none.
    type(time_function), intent(in) :: props(:)
    integer, intent(in) :: number
    real(wp), intent(in) :: time
    real(wp) :: factor
    integer :: i

    factor = 0
    if (size(props) == 0) factor = 1
    do i = 1, size(props)
      if (number == 0 .or. props(i)%number == number) factor = factor + props(i)%at(time)
    end do
  end function prescribed_factor

  pure function prescribed_rate(props, number, time) result(rate)
    !! d/dtime of `prescribed_factor`.
    type(time_function), intent(in) :: props(:)
    integer, intent(in) :: number
    real(wp), intent(in) :: time
    real(wp) :: rate
    integer :: i

    rate = 0
    do i = 1, size(props)
      if (number == 0 .or. props(i)%number == number) rate = rate + props(i)%slope(time)
    end do
  end function prescribed_rate

  subroutine expand(self, model, time, u)
    !! Set the prescribed and the linked values of u at a time.
    class(dof_map_type), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: u(:, :)  !! control values (ndf,nn)
    integer :: a, i, l, m

    do a = 1, self%nn
      if (self%count(a) == self%ndf) cycle
      do i = 1, self%ndf
        if (self%eq(i, a) /= is_prescribed) cycle
        if (model%disp(i, a) == 0) then  ! no product: 0 times a factor that is not finite stays 0
          u(i, a) = 0
        else
          u(i, a) = model%disp(i, a)*prescribed_factor(model%props, model%disp_prop(i, a), time)
        end if
      end do
    end do
    do l = 1, size(self%links)
      associate (d => self%links(l))
        u(d%comp, d%node) = d%constant
        do m = 1, size(d%nodes)
          u(d%comp, d%node) = u(d%comp, d%node) + d%coefs(m)*u(d%comps(m), d%nodes(m))
        end do
      end associate
    end do
  end subroutine expand

  subroutine reduce(self, f, r)
    !! Residual of the equations from nodal forces: r = (du/dq)^T f.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: f(:, :)   !! nodal forces (ndf,nn)
    real(wp), intent(out) :: r(:)     !! (neq)
    integer :: a, i, l, m, e

    do a = 1, self%nn
      do i = 1, self%ndf
        if (self%eq(i, a) > 0) r(self%eq(i, a)) = f(i, a)
      end do
    end do
    do l = 1, size(self%links)
      associate (d => self%links(l))
        do m = 1, size(d%nodes)
          e = self%eq(d%comps(m), d%nodes(m))
          if (e > 0) r(e) = r(e) + d%coefs(m)*f(d%comp, d%node)
        end do
      end associate
    end do
  end subroutine reduce

  subroutine add_increment(self, dq, u)
    !! u := u + (du/dq) dq for the free and the linked values.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: dq(:)       !! (neq)
    real(wp), intent(inout) :: u(:, :)  !! (ndf,nn)
    integer :: a, i, l, m, e

    do a = 1, self%nn
      do i = 1, self%ndf
        if (self%eq(i, a) > 0) u(i, a) = u(i, a) + dq(self%eq(i, a))
      end do
    end do
    do l = 1, size(self%links)
      associate (d => self%links(l))
        do m = 1, size(d%nodes)
          e = self%eq(d%comps(m), d%nodes(m))
          if (e > 0) u(d%comp, d%node) = u(d%comp, d%node) + d%coefs(m)*dq(e)
        end do
      end associate
    end do
  end subroutine add_increment

  subroutine follow(self, model, u)
    !! Recompute dependent values from those that they depend on.
    class(dof_map_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(inout) :: u(:, :)
    if (size(u) < 0 .or. model%nn < 0 .or. self%nn < 0) return
  end subroutine follow

  subroutine rates(self, model, time, du)
    !! du/dtime of prescribed values and, to first order, of what depends on them.
    class(dof_map_type), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(out) :: du(:, :)
    integer :: a, i, l, m

    du = 0
    do a = 1, self%nn
      do i = 1, self%ndf
        if (self%eq(i, a) == is_prescribed .and. abs(model%disp(i, a)) > 0) &
          du(i, a) = model%disp(i, a)*prescribed_rate(model%props, model%disp_prop(i, a), time)
      end do
    end do
    do l = 1, size(self%links)
      associate (d => self%links(l))
        do m = 1, size(d%nodes)
          du(d%comp, d%node) = du(d%comp, d%node) + d%coefs(m)*du(d%comps(m), d%nodes(m))
        end do
      end associate
    end do
  end subroutine rates

  subroutine spread_increment(self, dq, du)
    !! du := du + (du/dq) dq, to first order.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: dq(:)
    real(wp), intent(inout) :: du(:, :)
    call self%add_increment(dq, du)
  end subroutine spread_increment
end module dof_map
