module shell_conditions
  !! CLAMp and SYMMetry: conditions on place and slope of a shell's edges, through the dof map.
  !!
  !!     CLAMp roof.left [roof.right ...]       place and slope are fixed; the set roof.left.slope holds the nodes
  !!     SYMMetry roof.top [roof.bottom ...]    the plane across the edge is one of symmetry
  !!
  !! Without rotations as unknowns the slope of an edge is that of its two first rows of functions (module edge_rows). A
  !! clamp fixes the first and lets the second follow it, u_a = sum_b C_ab u_b: all components, or, where one normal n
  !! serves the whole edge, only n . u_a, so that the shell can stretch in its plane up to the edge. Symmetry with the plane's unit normal n keeps the first row in the plane and the slope normal to it:
  !!
  !!     n . u_a = 0 (first row),     t . (u_a - sum_b C_ab u_b) = 0 for both directions t in the plane (second row a)
  !!
  !! These are linear relations that hold at any displacement; they become links.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use messages, only: message_log, deck_place, quoted, name_hint, in_place
  use number_text, only: write_number
  use deck_record, only: record
  use model_data, only: model_type, set_surface, set_nodes
  use model_sets, only: find_set, find_set_of_kind, set_names, add_set
  use mesh_draft, only: draft_type, shell_request, append_value, value_request
  use edge_rows, only: edge_type, collect_edge, slope_nodes, slope_dependence
  use linear_relations, only: relation_set
  implicit none (type, external)
  private
  public :: read_shell_condition, resolve_clamps, resolve_slopes, shell_edge

contains

  subroutine read_shell_condition(command, draft, log)
    !! CLAMp or SYMMetry and the names of edges.
    type(record), intent(in) :: command
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(shell_request) :: new
    integer :: i

    if (command%count < 2) then
      call command%add_error(log, 'no edge is named', 'Write the names of surfaces, as roof.left')
      return
    end if
    do i = 2, command%count
      new%at = command%at
      new%keyword = command%key(1)
      call command%text(i, new%set, log, 'surface')
      if (len(new%set) > 0) draft%shell_conditions = [draft%shell_conditions, new]
    end do
  end subroutine read_shell_condition

  integer function shell_edge(model, draft, at, command, name, log) result(set)
    !! The surface of this name if its members are sides of shells; 0 after an error.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: command, name
    type(message_log), intent(inout) :: log

    set = find_set_of_kind(model, name, set_surface)
    if (set == 0) then
      call log%add_error(at, command, 'there is no edge ' // quoted(name), &
        name_hint(name, set_names(model, set_surface), 'surfaces'))
      return
    end if
    associate (items => model%sets(set)%items, sides => model%sets(set)%sides)
      if (size(items) == 0) then
        if (.not. draft%has_lost_sets) call log%add_error(at, command, quoted(name) // ' has no elements', &
          name_hint('', set_names(model, set_surface), 'surfaces'))
        set = 0
      else if (model%ndm /= 3 .or. any(model%mesh%dp(items) /= 2) .or. any(sides < 1)) then
        call log%add_error(at, command, quoted(name) // ' is not the edge of a shell', &
          'The sides of a surface patch are its edges; a solid is held by BOUNdary')
        set = 0
      end if
    end associate
  end function shell_edge

  subroutine resolve_clamps(model, draft, log)
    !! Before the conditions: clamped edges are fixed; both rows become a node set.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(value_request) :: fix
    integer :: i, set

    do i = 1, size(draft%shell_conditions)
      associate (request => draft%shell_conditions(i))
        if (request%keyword /= 'clam') cycle
        set = shell_edge(model, draft, request%at, 'CLAMp', request%set, log)
        if (set == 0) cycle
        if (find_set(model, request%set // '.slope') == 0) call add_set(model, request%set // '.slope', &
          in_place(request%at), set_nodes, slope_nodes(model, set), [integer ::])
        fix%at = request%at
        fix%set = request%set
        fix%v1 = spread(1.0_wp, 1, model%ndf)
        fix%v2 = fix%v1
        call append_value(draft%boundary, draft%n_boundary, fix)
      end associate
    end do
  end subroutine resolve_clamps

  subroutine resolve_slopes(model, draft, log)
    !! Slopes of clamps, then planes of symmetry; after the conditions and the links.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(relation_set) :: relations
    integer :: i, set

    if (size(draft%shell_conditions) == 0) return
    call relations%start(model)
    do i = 1, size(draft%shell_conditions)
      associate (request => draft%shell_conditions(i))
        if (request%keyword /= 'clam') cycle
        set = find_set_of_kind(model, request%set, set_surface)
        if (set == 0) cycle
        if (any(model%mesh%dp(model%sets(set)%items) /= 2)) cycle   ! refused by resolve_clamps
        call add_clamp(model, request, set, relations, log)
      end associate
    end do
    do i = 1, size(draft%shell_conditions)
      associate (request => draft%shell_conditions(i))
        if (request%keyword /= 'symm') cycle
        set = shell_edge(model, draft, request%at, 'SYMMetry', request%set, log)
        if (set > 0) call add_symmetry(model, request, set, relations, log)
      end associate
    end do
    call relations%finish(model)
  end subroutine resolve_slopes

  subroutine add_clamp(model, request, set, relations, log)
    type(model_type), intent(inout) :: model
    type(shell_request), intent(in) :: request
    integer, intent(in) :: set
    type(relation_set), intent(inout) :: relations
    type(message_log), intent(inout) :: log
    type(edge_type) :: edge
    real(wp), allocatable :: coef(:, :)
    real(wp) :: directions(3, 3), error
    integer :: k, status
    logical :: contradicts, flat

    call collect_edge(model, set, edge, status)
    if (status == ok) call slope_dependence(edge%slope, edge%length, size(edge%first), coef, error, status)
    if (status /= ok) then
      call log%add_error(request%at, 'CLAMp', 'the functions behind ' // quoted(request%set) // &
        ' cannot set its slope', 'Shells need smooth bases of degree 2 or more, as NURBS, and edges of some length')
      return
    end if
    directions = 0
    do k = 1, 3
      directions(k, k) = 1
    end do
    flat = all(matmul(edge%nrm(:, 1), edge%nrm) > 1 - 1e-12_wp)
    if (flat) then
      directions(:, 1) = edge%nrm(:, 1)
      where (abs(directions(:, 1)) < 1e-12_wp) directions(:, 1) = 0
    end if
    call add_second_row(model, edge, coef, directions(:, :merge(1, 3, flat)), in_place(request%at), relations, contradicts)
    if (contradicts) call log%add_error(request%at, 'CLAMp', 'values prescribed behind ' // quoted(request%set) // &
      ' contradict the clamp', 'Prescribe values on the edge itself; what is behind follows')
  end subroutine add_clamp

  subroutine add_second_row(model, edge, coef, t, place, relations, contradicts)
    !! t . (u_a - sum_b C_ab u_b) = 0 for the second row and all directions t.
    type(model_type), intent(inout) :: model
    type(edge_type), intent(in) :: edge
    real(wp), intent(in) :: coef(:, :)                  !! C
    real(wp), intent(in) :: t(:, :)                     !! (3,directions)
    character(*), intent(in) :: place
    type(relation_set), intent(inout) :: relations
    logical, intent(out) :: contradicts
    integer, allocatable :: nodes(:), masters(:)
    integer :: a, b, i, k
    logical :: wrong

    contradicts = .false.
    do a = 1, size(edge%second)
      masters = pack([(b, b=1, size(edge%first))], abs(coef(a, :)) > 0)
      nodes = [edge%second(a), edge%first(masters)]
      do k = 1, size(t, 2)
        call relations%add(model, [((nodes(b), i=1, 3), b=1, size(nodes))], [((i, i=1, 3), b=1, size(nodes))], &
          [t(:, k), ((-coef(a, masters(b))*t(i, k), i=1, 3), b=1, size(masters))], place, wrong)
        contradicts = contradicts .or. wrong
      end do
    end do
  end subroutine add_second_row

  subroutine add_symmetry(model, request, set, relations, log)
    type(model_type), intent(inout) :: model
    type(shell_request), intent(in) :: request
    integer, intent(in) :: set
    type(relation_set), intent(inout) :: relations
    type(message_log), intent(inout) :: log
    type(edge_type) :: edge
    real(wp), allocatable :: coef(:, :)
    real(wp) :: n(3), t(3, 2), error, off, slant
    real(wp), parameter :: near = 1e-6_wp
    integer :: a, n1, status
    logical :: wrong, contradicts
    character(:), allocatable :: place

    call collect_edge(model, set, edge, status)
    if (status /= ok) then
      call log%add_error(request%at, 'SYMMetry', 'the edge ' // quoted(request%set) // ': ' // status_text(status), &
        'A pole needs no condition of its own')
      return
    end if
    n = matmul(edge%nu, edge%length)
    n = n/max(norm2(n), tiny(1.0_wp))
    where (abs(n) < 1e-9_wp) n = 0
    if (norm2(n) > 0) n = n/norm2(n)
    off = maxval(abs(matmul(n, edge%x) - dot_product(n, edge%x(:, 1))))/maxval(abs(model%x))
    slant = 0
    do a = 1, size(edge%nu, 2)
      slant = max(slant, norm2(edge%nu(:, a) - n))
    end do
    if (off > near .or. slant > near) then
      call log%add_error(request%at, 'SYMMetry', 'the shell does not meet a plane at right angles along ' // &
        quoted(request%set), 'Along an edge of symmetry the surface is normal to one plane; of a QUADmesh on a sphere, '// &
        'write SPHEre x y z r SYMMetric')
      return
    end if
    n1 = size(edge%first)
    call slope_dependence(edge%slope, edge%length, n1, coef, error, status)
    if (status /= ok) then
      call log%add_error(request%at, 'SYMMetry', 'the functions behind ' // quoted(request%set) // &
        ' cannot set its slope', 'Shells need smooth bases of degree 2 or more, as NURBS')
      return
    end if
    if (error > near) call log%add_warning(request%at, 'SYMMetry', 'the slope along ' // quoted(request%set) // &
      ' is kept in the mean only (the largest rest is ' // write_number(error) // ' of a unit slope)', &
      'Weights in the two rows behind an edge should have one ratio')

    call directions_across(n, t)
    place = in_place(request%at)
    wrong = .false.
    do a = 1, n1
      call relations%add(model, [edge%first(a), edge%first(a), edge%first(a)], [1, 2, 3], n, place, contradicts)
      wrong = wrong .or. contradicts
    end do
    call add_second_row(model, edge, coef, t, place, relations, contradicts)
    wrong = wrong .or. contradicts
    if (wrong) call log%add_error(request%at, 'SYMMetry', 'values prescribed on ' // quoted(request%set) // &
      ' or behind it contradict the symmetry', 'Nothing moves across the plane, both rows behind the edge move alike')
  end subroutine add_symmetry

  pure subroutine directions_across(n, t)
    !! Two orthonormal directions normal to n; axes if n is one.
    real(wp), intent(in) :: n(3)
    real(wp), intent(out) :: t(3, 2)
    integer :: k

    k = maxloc(abs(n), 1)
    t = 0
    t(mod(k, 3) + 1, 1) = 1
    t(:, 1) = t(:, 1) - n*dot_product(n, t(:, 1))
    t(:, 1) = t(:, 1)/norm2(t(:, 1))
    t(1, 2) = n(2)*t(3, 1) - n(3)*t(2, 1)
    t(2, 2) = n(3)*t(1, 1) - n(1)*t(3, 1)
    t(3, 2) = n(1)*t(2, 1) - n(2)*t(1, 1)
  end subroutine directions_across
end module shell_conditions
