module dof_map
  !! From control values to equations. A control value is free, prescribed, or depends on others: linearly (LINK), or as
  !! a point of a rigid face that turns (ENDFace). Globals (the angle of a face) are further columns behind those of the
  !! control points, with conditions and equations like them; columns number model%nn + 1 to model%columns().
  !!
  !! The force of a global is the sum of what its dependents carry, f_q = sum_k f_k du_k/dq: an equation where the global
  !! is free (`reduce`), a reaction where it is prescribed (`add_reactions`).
  use kinds, only: wp
  use model_data, only: model_type, time_function
  use end_face, only: end_face_geometry, turn
  implicit none (type, external)
  private
  public :: dof_map_type, build_dof_map, prescribed_factor, prescribed_rate, is_prescribed, is_linked

  integer, parameter :: is_prescribed = 0  !! value of `eq` for a prescribed dof; a linked dof k has eq = -k
  integer, parameter :: angle = 1, multiplier = 2   !! components of a face's column

  type :: linked_dof
    integer :: node = 0, comp = 0
    integer, allocatable :: nodes(:), comps(:)  !! the dofs it depends on, none of them linked itself
    real(wp), allocatable :: coefs(:)           !! derivatives with respect to them; of a face's point: at present
    real(wp) :: constant = 0
    real(wp) :: curve = 0                       !! second derivative with respect to the angle, the last of the masters
  end type linked_dof

  type :: dof_map_type
    integer :: ndf = 0, nn = 0, neq = 0     !! nn: columns of control values
    integer :: controls = 0                 !! columns of control points, globals follow
    integer :: multipliers = 0              !! free Lagrange multipliers: so many eigenvalues are negative at a minimum
    integer, allocatable :: eq(:, :)        !! (ndf,nn): > 0 equation, 0 prescribed, -k linked dof k
    integer, allocatable :: first(:)        !! (nn) first equation of a node
    integer, allocatable :: count(:)        !! (nn) its free components
    logical, allocatable :: has_link(:)     !! (nn) some component is linked
    type(linked_dof), allocatable :: links(:)  !! linear ones, then those of the rigid faces
    integer :: linear = 0                   !! how many are linear
    type(end_face_geometry), allocatable :: faces(:)
    integer, allocatable, private :: first_link(:)   !! of each rigid face, its points and their components in order
  contains
    procedure :: expand
    procedure :: follow
    procedure :: linearise
    procedure :: complete_increment
    procedure :: prescribed_increment
    procedure :: rates
    procedure :: add_reactions
    procedure :: support_forces
    procedure :: reduce
    procedure :: add_increment
    procedure :: spread_increment
    procedure :: prescribed_work
    procedure :: residual_size
    procedure :: force_size
    procedure :: reaction_size
    procedure :: value_size
    procedure :: increment_size
  end type dof_map_type

contains

  elemental function is_linked(eq) result(yes)
    integer, intent(in) :: eq
    logical :: yes
    yes = eq < 0
  end function is_linked

  subroutine build_dof_map(model, faces, map)
    !! Number the free dofs. Chains of links were resolved by the deck's check: masters are not linked themselves.
    type(model_type), intent(in) :: model
    type(end_face_geometry), intent(in) :: faces(:)   !! of model%end_faces
    type(dof_map_type), intent(out) :: map
    integer :: a, i, l, k

    map%ndf = model%ndf
    map%controls = model%nn
    map%nn = model%columns()
    allocate (map%eq(map%ndf, map%nn), map%first(map%nn), map%count(map%nn), map%has_link(map%nn))
    map%eq = 1
    where (model%fixed) map%eq = is_prescribed
    map%has_link = .false.
    map%faces = faces
    if (allocated(model%links)) map%linear = size(model%links)
    allocate (map%first_link(size(faces)), source=0)
    l = map%linear
    do k = 1, size(faces)
      if (.not. faces(k)%rigid) cycle
      map%first_link(k) = l + 1
      l = l + size(faces(k)%arm)
    end do
    allocate (map%links(l))
    do l = 1, map%linear
      associate (from => model%links(l))
        map%links(l)%node = from%node
        map%links(l)%comp = from%comp
        map%links(l)%nodes = from%nodes
        map%links(l)%comps = from%comps
        map%links(l)%coefs = from%coefs
        map%links(l)%constant = from%constant
      end associate
    end do
    do k = 1, size(faces)
      if (faces(k)%rigid) then
        call link_face(faces(k), map%links(map%first_link(k):))
      else if (.not. model%fixed(multiplier, faces(k)%rotation)) then
        map%multipliers = map%multipliers + 1
      end if
    end do
    do l = 1, size(map%links)
      map%eq(map%links(l)%comp, map%links(l)%node) = -l
      map%has_link(map%links(l)%node) = .true.
    end do
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

  subroutine link_face(face, links)
    !! Each component of each point of a rigid face depends on that of the translation and on the angle.
    type(end_face_geometry), intent(in) :: face
    type(linked_dof), intent(inout) :: links(:)   !! at least size(face%arm)
    integer :: a, i, l

    l = 0
    do a = 1, size(face%nodes)
      do i = 1, size(face%arm, 1)
        l = l + 1
        links(l)%node = face%nodes(a)
        links(l)%comp = i
        links(l)%nodes = [face%translation, face%rotation]
        links(l)%comps = [i, angle]
        links(l)%coefs = [1.0_wp, 0.0_wp]
      end do
    end do
  end subroutine link_face

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
    !! Set the prescribed values of u at a time, and all that depend on others.
    class(dof_map_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: u(:, :)  !! control values (ndf,nn)

    call set_prescribed(self, model, time, u)
    call self%follow(u)
  end subroutine expand

  subroutine set_prescribed(self, model, time, u)
    type(dof_map_type), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(inout) :: u(:, :)
    integer :: a, i

    do a = 1, self%nn
      if (self%count(a) == self%ndf) cycle
      do i = 1, self%ndf
        if (self%eq(i, a) /= is_prescribed) cycle
        if (abs(model%disp(i, a)) > 0) then  ! no product: 0 times a factor that is not finite stays 0
          u(i, a) = model%disp(i, a)*prescribed_factor(model%props, model%disp_prop(i, a), time)
        else
          u(i, a) = 0
        end if
      end do
    end do
  end subroutine set_prescribed

  subroutine follow(self, u)
    !! Set all values of u that depend on others, and renew their derivatives.
    class(dof_map_type), intent(inout) :: self
    real(wp), intent(inout) :: u(:, :)  !! control values (ndf,nn)
    integer :: a, k, l, m, n

    do l = 1, self%linear
      associate (d => self%links(l))
        u(d%comp, d%node) = d%constant
        do m = 1, size(d%nodes)
          u(d%comp, d%node) = u(d%comp, d%node) + d%coefs(m)*u(d%comps(m), d%nodes(m))
        end do
      end associate
    end do
    do k = 1, size(self%faces)
      associate (face => self%faces(k))
        if (.not. face%rigid) cycle
        n = size(face%arm, 1)
        l = self%first_link(k)
        do a = 1, size(face%nodes)
          call move_point(face%axis, u(angle, face%rotation), face%arm(:, a), u(1:n, face%translation), &
                          u(1:n, face%nodes(a)), self%links(l:l + n - 1))
          l = l + n
        end do
      end associate
    end do
  end subroutine follow

  pure subroutine move_point(axis, theta, arm, translation, u, links)
    !! A point of a rigid face: its displacement, and the derivatives of that.
    real(wp), intent(in) :: axis(3), theta
    real(wp), intent(in) :: arm(:), translation(:)   !! (ndm)
    real(wp), intent(out) :: u(:)                    !! (ndm)
    type(linked_dof), intent(inout) :: links(:)      !! (ndm)
    real(wp), dimension(size(arm)) :: change, first, second
    integer :: i

    call turn(axis, theta, arm, change, first, second)
    u = translation + change
    do i = 1, size(arm)
      links(i)%coefs(2) = first(i)
      links(i)%curve = second(i)
    end do
  end subroutine move_point

  subroutine linearise(self, u)
    !! Renew the derivatives at control values that follow already.
    class(dof_map_type), intent(inout) :: self
    real(wp), intent(in) :: u(:, :)  !! control values (ndf,nn)
    real(wp) :: same(size(u, 1))
    integer :: a, k, l, n

    do k = 1, size(self%faces)
      associate (face => self%faces(k))
        if (.not. face%rigid) cycle
        n = size(face%arm, 1)
        l = self%first_link(k)
        do a = 1, size(face%nodes)
          call move_point(face%axis, u(angle, face%rotation), face%arm(:, a), u(1:n, face%translation), same(1:n), &
                          self%links(l:l + n - 1))
          l = l + n
        end do
      end associate
    end do
  end subroutine linearise

  subroutine complete_increment(self, du)
    !! Set increments (or rates) of dependent values to first order, from those of the values that they depend on.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(inout) :: du(:, :)  !! (ndf,nn)
    integer :: l, m

    do l = 1, size(self%links)
      associate (d => self%links(l))
        du(d%comp, d%node) = 0
        do m = 1, size(d%nodes)
          du(d%comp, d%node) = du(d%comp, d%node) + d%coefs(m)*du(d%comps(m), d%nodes(m))
        end do
      end associate
    end do
  end subroutine complete_increment

  subroutine prescribed_increment(self, model, time, u, du)
    !! What the prescribed values at a time differ from u by, and what depends on them to first order; free ones: 0.
    class(dof_map_type), intent(inout) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(in) :: u(:, :)    !! (ndf,nn)
    real(wp), intent(out) :: du(:, :)  !! (ndf,nn)

    call self%linearise(u)
    du = u
    call set_prescribed(self, model, time, du)
    du = du - u
    call self%complete_increment(du)
  end subroutine prescribed_increment

  subroutine rates(self, model, time, rate)
    !! d u / d time of the prescribed values and of what depends on them, by the present derivatives; free ones: 0.
    class(dof_map_type), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: time
    real(wp), intent(out) :: rate(:, :)   !! (ndf,nn)
    integer :: a, i

    rate = 0
    do a = 1, self%nn
      if (self%count(a) == self%ndf) cycle
      do i = 1, self%ndf
        if (self%eq(i, a) == is_prescribed .and. abs(model%disp(i, a)) > 0) &
          rate(i, a) = model%disp(i, a)*prescribed_rate(model%props, model%disp_prop(i, a), time)
      end do
    end do
    call self%complete_increment(rate)
  end subroutine rates

  subroutine add_reactions(self, f)
    !! Add to the forces of prescribed globals what the points of their faces carry. Once for an array of nodal forces.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(inout) :: f(:, :)   !! nodal forces (ndf,nn)
    integer :: l, m

    do l = self%linear + 1, size(self%links)
      associate (d => self%links(l))
        do m = 1, size(d%nodes)
          if (self%eq(d%comps(m), d%nodes(m)) /= is_prescribed) cycle
          f(d%comps(m), d%nodes(m)) = f(d%comps(m), d%nodes(m)) + d%coefs(m)*f(d%comp, d%node)
        end do
      end associate
    end do
  end subroutine add_reactions

  pure subroutine support_forces(self, f, supports)
    !! What supports apply: forces at linked values act on those that these depend on.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: f(:, :)            !! nodal forces (ndf,nn)
    real(wp), intent(out) :: supports(:, :)    !! (ndf,nn)
    integer :: l, m

    supports = f
    do l = 1, self%linear
      associate (d => self%links(l))
        supports(d%comp, d%node) = supports(d%comp, d%node) - f(d%comp, d%node)
        do m = 1, size(d%nodes)
          supports(d%comps(m), d%nodes(m)) = supports(d%comps(m), d%nodes(m)) + d%coefs(m)*f(d%comp, d%node)
        end do
      end associate
    end do
  end subroutine support_forces

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
    !! Add dq to the free values of u; dependent ones follow exactly.
    class(dof_map_type), intent(inout) :: self
    real(wp), intent(in) :: dq(:)       !! (neq)
    real(wp), intent(inout) :: u(:, :)  !! (ndf,nn)
    integer :: a, i

    do a = 1, self%nn
      do i = 1, self%ndf
        if (self%eq(i, a) > 0) u(i, a) = u(i, a) + dq(self%eq(i, a))
      end do
    end do
    call self%follow(u)
  end subroutine add_increment

  subroutine spread_increment(self, dq, du)
    !! du := du + (du/dq) dq, by the present derivatives.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: dq(:)        !! (neq)
    real(wp), intent(inout) :: du(:, :)  !! (ndf,nn)
    integer :: a, i, l, m, e

    do a = 1, self%nn
      do i = 1, self%ndf
        if (self%eq(i, a) > 0) du(i, a) = du(i, a) + dq(self%eq(i, a))
      end do
    end do
    do l = 1, size(self%links)
      associate (d => self%links(l))
        do m = 1, size(d%nodes)
          e = self%eq(d%comps(m), d%nodes(m))
          if (e > 0) du(d%comp, d%node) = du(d%comp, d%node) + d%coefs(m)*dq(e)
        end do
      end associate
    end do
  end subroutine spread_increment

  pure function prescribed_work(self, f, du) result(work)
    !! Work of the reactions f on an increment: over prescribed values and what is linked to them.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: f(:, :), du(:, :)   !! (ndf,nn)
    real(wp) :: work
    integer :: l, m

    work = sum(f*du, mask=self%eq == is_prescribed)
    do l = 1, self%linear
      associate (d => self%links(l))
        do m = 1, size(d%nodes)
          if (self%eq(d%comps(m), d%nodes(m)) == is_prescribed) &
            work = work + f(d%comp, d%node)*d%coefs(m)*du(d%comps(m), d%nodes(m))
        end do
      end associate
    end do
  end function prescribed_work

  ! Sizes compare unlike quantities: a moment counts by the force, an angle by the displacement at the face's radius of
  ! inertia. The condition of a multiplier is an angle, thus relative by itself; its value is no displacement.

  pure function residual_size(self, r, reference) result(length)
    !! |r| of the equations, with `reference` for the size of forces.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: r(:)            !! (neq)
    real(wp), intent(in) :: reference
    real(wp) :: length, squares
    integer :: k, e

    length = norm2(r)
    if (size(self%faces) == 0) return
    squares = 0
    do e = 1, self%neq
      if (e >= self%first(self%controls + 1)) exit
      squares = squares + r(e)**2
    end do
    do k = 1, size(self%faces)
      associate (face => self%faces(k))
        if (face%rigid) squares = squares + sum(free_values(face%translation, self%ndf)**2)
        e = self%eq(angle, face%rotation)
        if (e > 0) squares = squares + (r(e)/face%radius)**2
        e = self%eq(multiplier, face%rotation)
        if (e > 0) squares = squares + (r(e)*reference)**2
      end associate
    end do
    length = sqrt(squares)

  contains

    pure function free_values(column, n) result(values)
      integer, intent(in) :: column, n
      real(wp) :: values(n)
      integer :: i

      values = 0
      do i = 1, n
        if (self%eq(i, column) > 0) values(i) = r(self%eq(i, column))
      end do
    end function free_values
  end function residual_size

  pure function force_size(self, f) result(length)
    !! |f| over all control values.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: f(:, :)         !! (ndf,nn)
    real(wp) :: length
    logical :: all_of(self%ndf, self%nn)

    all_of = .true.
    length = weighted_norm(self, f, all_of)
  end function force_size

  pure function reaction_size(self, f) result(length)
    !! |f| over the prescribed control values.
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: f(:, :)         !! (ndf,nn)
    real(wp) :: length

    length = weighted_norm(self, f, self%eq == is_prescribed)
  end function reaction_size

  pure function weighted_norm(self, f, mask) result(length)
    type(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: f(:, :)         !! (ndf,nn)
    logical, intent(in) :: mask(:, :)
    real(wp) :: length
    integer :: k

    associate (n => self%controls)
      length = sum(f(:, 1:n)**2, mask=mask(:, 1:n))
    end associate
    do k = 1, size(self%faces)
      associate (face => self%faces(k))
        if (face%rigid) length = length + sum(f(:, face%translation)**2, mask=mask(:, face%translation))
        if (mask(angle, face%rotation)) length = length + (f(angle, face%rotation)/face%radius)**2
      end associate
    end do
    length = sqrt(length)
  end function weighted_norm

  pure function value_size(self, u) result(largest)
    !! Largest control value [length].
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: u(:, :)         !! (ndf,nn)
    real(wp) :: largest
    integer :: k

    largest = maxval(abs(u(:, 1:self%controls)))
    do k = 1, size(self%faces)
      associate (face => self%faces(k))
        largest = max(largest, face%radius*abs(u(angle, face%rotation)))
      end associate
    end do
  end function value_size

  pure function increment_size(self, dq) result(largest)
    !! Largest increment [length].
    class(dof_map_type), intent(in) :: self
    real(wp), intent(in) :: dq(:)           !! (neq)
    real(wp) :: largest
    integer :: k, e

    e = self%neq
    if (self%nn > self%controls) e = self%first(self%controls + 1) - 1
    largest = 0
    if (e > 0) largest = maxval(abs(dq(1:e)))
    do k = 1, size(self%faces)
      associate (face => self%faces(k))
        e = self%eq(angle, face%rotation)
        if (e > 0) largest = max(largest, face%radius*abs(dq(e)))
        if (.not. face%rigid) cycle
        e = maxval(self%eq(:, face%translation))
        if (e > 0) largest = max(largest, maxval(abs(dq(self%first(face%translation):e))))
      end associate
    end do
  end function increment_size
end module dof_map
