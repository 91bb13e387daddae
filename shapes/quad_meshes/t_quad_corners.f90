module t_quad_corners
  !! Which vertices of a face are its four corners, and which are T-junctions.
  !!
  !! A T-junction lies inside the surface and has three faces, in one of which it is no corner. What
  !! follows from counting is taken first: a face of 4 + m vertices needs m T-junctions among its
  !! vertices of three faces, and a vertex is a T-junction in one face at most. Where counting
  !! leaves a choice, because a vertex of three faces may be an extraordinary point too, the
  !! straightest angles decide, if they are clearly straighter than the others.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use t_quad_mesh, only: t_quad_mesh_type
  implicit none (type, external)
  private
  public :: find_corners

  integer, parameter :: unknown = 0, corner = 1, junction = 2
  real(wp), parameter :: clearly = acos(-1.0_wp)/9     ! 20 degrees

contains

  subroutine find_corners(mesh, message)
    !! Sets is_corner.
    type(t_quad_mesh_type), intent(inout) :: mesh
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    integer, allocatable :: role(:)
    integer :: f, h
    logical :: changed

    message = ''
    allocate (role(mesh%nh), source=corner)
    do h = 1, mesh%nh
      if (may_be_junction(mesh, h)) role(h) = unknown
    end do
    do
      changed = .false.
      do f = 1, mesh%nf
        call count_face(mesh, f, role, changed, message)
        if (len(message) > 0) return
      end do
      if (changed) cycle
      if (.not. any(role == unknown)) exit
      call look_at_angles(mesh, role, changed)
      if (changed) cycle
      f = mesh%face(findloc(role, unknown, dim=1))
      message = 'the four corners of face ' // whole_number(f) // ' are not certain: vertices' // &
        undecided(mesh, f, role) // ' may be T-junctions or corners. Move the T-junctions onto ' &
        // 'straight sides'
      return
    end do
    mesh%is_corner = role == corner
  end subroutine find_corners

  pure logical function may_be_junction(mesh, h)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h                 !! half-edge

    integer :: f, v

    f = mesh%face(h)
    v = mesh%vertex(h)
    may_be_junction = mesh%first(f+1) - mesh%first(f) > 4 .and. mesh%faces(v) == 3
    if (may_be_junction) may_be_junction = mesh%twin(mesh%out(v)) > 0
  end function may_be_junction

  pure subroutine count_face(mesh, f, role, changed, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    integer, intent(inout) :: role(:)        !! of the starts of half-edges
    logical, intent(inout) :: changed
    character(:), allocatable, intent(inout) :: message

    integer :: h, left, needed

    associate (own => role(mesh%first(f):mesh%first(f+1)-1))
      left = count(own == unknown)
      needed = size(own) - 4 - count(own == junction)
      if (needed < 0 .or. needed > left) then
        message = 'face ' // whole_number(f) // ' has ' // whole_number(size(own)) // &
          ' vertices, ' // whole_number(left + count(own == junction)) // &
          ' of which can be T-junctions (vertices inside the surface of three faces, and on a ' // &
          'side in one of them only): it is not a quadrilateral. Divide the face at its other vertices'
        return
      end if
    end associate
    if (left == 0 .or. (needed > 0 .and. needed < left)) return
    changed = .true.
    do h = mesh%first(f), mesh%first(f+1) - 1
      if (role(h) /= unknown) cycle
      if (needed == 0) then
        role(h) = corner
      else
        call make_junction(mesh, h, role)
      end if
    end do
  end subroutine count_face

  pure subroutine make_junction(mesh, h, role)
    !! A corner in its other faces.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h
    integer, intent(inout) :: role(:)

    integer :: other

    role(h) = junction
    other = mesh%turn(h)
    do while (other /= h)
      role(other) = corner
      other = mesh%turn(other)
    end do
  end subroutine make_junction

  subroutine look_at_angles(mesh, role, changed)
    !! The first face whose straightest angles tell.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(inout) :: role(:)
    logical, intent(inout) :: changed

    real(wp), allocatable :: bend(:)
    logical, allocatable :: chosen(:)
    integer :: f, h, k, needed

    allocate (bend(mesh%nh), chosen(mesh%nh))
    do f = 1, mesh%nf
      associate (a => mesh%first(f), b => mesh%first(f+1) - 1)
        if (.not. any(role(a:b) == unknown)) cycle
        needed = b - a - 3 - count(role(a:b) == junction)
        bend = huge(1.0_wp)
        do h = a, b
          if (role(h) == unknown) bend(h) = bend_at(mesh, h)
        end do
        chosen = .false.
        do k = 1, needed
          h = a - 1 + minloc(bend(a:b), mask=.not. chosen(a:b), dim=1)
          chosen(h) = .true.
        end do
        if (minval(bend(a:b), mask=.not. chosen(a:b)) - maxval(bend(a:b), mask=chosen(a:b)) &
          < clearly) cycle
        do h = a, b
          if (chosen(h)) call make_junction(mesh, h, role)
        end do
        changed = .true.
        return
      end associate
    end do
  end subroutine look_at_angles

  pure real(wp) function bend_at(mesh, h)
    !! How much the outline of a face turns at a vertex [rad].
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h

    real(wp) :: a(3), b(3), cosine

    a = mesh%x(:,mesh%vertex(h)) - mesh%x(:,mesh%vertex(mesh%previous(h)))
    b = mesh%x(:,mesh%vertex(mesh%next(h))) - mesh%x(:,mesh%vertex(h))
    cosine = 0
    if (norm2(a)*norm2(b) > 0) cosine = dot_product(a, b)/(norm2(a)*norm2(b))
    bend_at = acos(min(max(cosine, -1.0_wp), 1.0_wp))
  end function bend_at

  pure function undecided(mesh, f, role) result(list)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    integer, intent(in) :: role(:)
    character(:), allocatable :: list

    integer :: h

    list = ''
    do h = mesh%first(f), mesh%first(f+1) - 1
      if (role(h) == unknown) list = list // ' ' // whole_number(mesh%vertex(h))
    end do
  end function undecided
end module t_quad_corners
