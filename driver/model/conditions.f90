module conditions
  !! Boundary codes, prescribed values, nodal forces, time functions and links, put on the nodes of
  !! the finished mesh. Codes accumulate (a dof that any record fixes is fixed); of values, a later
  !! nonzero one replaces an earlier.
  use kinds, only: wp
  use messages, only: message_log, deck_place, whole_text, quoted, name_hint, in_place
  use number_text, only: read_number, equal
  use model_data, only: model_type, linear_constraint
  use model_sets, only: find_set, nodes_of_set, set_names
  use mesh_draft, only: draft_type, value_request, link_request
  implicit none (type, external)
  private
  public :: resolve_conditions, resolve_links

contains

  subroutine resolve_conditions(model, draft, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    integer, allocatable :: number(:, :)
    integer :: i

    allocate (model%fixed(model%ndf, model%nn), source=.false.)
    allocate (model%disp(model%ndf, model%nn), model%force(model%ndf, model%nn), source=0.0_wp)
    allocate (number(model%ndf, model%nn), source=0)
    do i = 1, draft%n_boundary
      call put_values('BOUNdary', draft%boundary(i))
    end do
    do i = 1, draft%n_displacement
      call put_values('DISPlacement', draft%displacement(i))
    end do
    do i = 1, draft%n_force
      call put_values('FORCe', draft%force(i))
    end do
    do i = 1, draft%n_proportional
      call put_values('FPROportional', draft%proportional(i))
    end do
    model%disp_prop = number
    call move_alloc(number, model%force_prop)

  contains

    subroutine put_values(command, request)
      character(*), intent(in) :: command
      type(value_request), intent(in) :: request
      integer, allocatable :: nodes(:)
      real(wp) :: part, v(model%ndf)
      integer :: k, j, a
      logical :: told

      call nodes_of_request(model, draft, request, command, nodes, log)
      told = .false.
      do k = 1, size(nodes)
        a = nodes(k)
        part = 0
        if (size(nodes) > 1) part = real(k - 1, wp)/(size(nodes) - 1)
        if (request%keeps) part = 0
        v = request%v1 + part*(request%v2 - request%v1)
        do j = 1, model%ndf
          if (equal(v(j), 0.0_wp)) cycle
          select case (command)
          case ('BOUNdary')
            model%fixed(j, a) = .true.
          case ('DISPlacement')
            model%disp(j, a) = v(j)
            if (.not. model%fixed(j, a) .and. .not. told) then
              told = .true.
              call log%add_error(request%at, command, 'direction ' // whole_text(j) // ' of ' // &
                target_name(request, a) // ' has a prescribed value but is free', &
                'Fix it: a record of BOUNdary with a 1 for direction ' // whole_text(j))
            end if
          case ('FORCe')
            model%force(j, a) = v(j)
            if (model%fixed(j, a) .and. .not. told) then
              told = .true.
              call log%add_warning(request%at, command, 'direction ' // whole_text(j) // ' of ' // &
                target_name(request, a) // ' is fixed, the force on it only adds to the reaction', &
                '')
            end if
          case default
            number(j, a) = nint(v(j))
            if (.not. any(model%props(:)%number == number(j, a)) .and. .not. told) then
              told = .true.
              call log%add_error(request%at, command, 'there is no time function ' // &
                whole_text(number(j, a)), &
                'Define it: PROPortional ' // whole_text(number(j, a)) // &
                ', then lines of time and value')
            end if
          end select
        end do
      end do
    end subroutine put_values
  end subroutine resolve_conditions

  pure function target_name(request, a) result(text)
    type(value_request), intent(in) :: request
    integer, intent(in) :: a                  !! node, if no set is named
    character(:), allocatable :: text

    if (allocated(request%set)) then
      text = 'the set ' // request%set
    else
      text = 'node ' // whole_text(a)
    end if
  end function target_name

  subroutine nodes_of_request(model, draft, request, command, nodes, log)
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(value_request), intent(in) :: request
    character(*), intent(in) :: command
    integer, allocatable, intent(out) :: nodes(:)   !! none after an error
    type(message_log), intent(inout) :: log
    integer :: i, set

    allocate (nodes(0))
    if (allocated(request%set)) then
      set = find_set(model, request%set)
      if (set == 0) then
        call log%add_error(request%at, command, 'there is no set ' // quoted(request%set), &
          name_hint(request%set, set_names(model, 0), 'sets'))
        return
      end if
      nodes = nodes_of_set(model, set)
      return
    end if
    do i = request%first, request%last, request%step
      if (i < 1 .or. i > model%nn) then
        call log%add_error(request%at, command, 'there is no node ' // whole_text(i), &
          'Nodes are numbered from 1 to ' // whole_text(model%nn))
        nodes = [integer ::]
        return
      end if
    end do
    nodes = draft%tied_to([(i, i = request%first, request%last, request%step)])
  end subroutine nodes_of_request

  subroutine resolve_links(model, draft, log)
    !! After the conditions. Chains are resolved: no master is linked itself.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(linear_constraint), allocatable :: links(:)
    integer, allocatable :: slaves(:), one(:), masters(:), which(:, :)
    type(linear_constraint) :: link
    integer :: i, k, n, first_error
    logical :: good

    first_error = log%error_count()
    allocate (links(0), which(model%ndf, model%nn))
    which = 0
    do i = 1, size(draft%links)
      associate (request => draft%links(i))
        call nodes_of_name(model, draft, request%at, request%slave, slaves, log)
        good = size(slaves) > 0
        masters = [integer ::]
        do k = 1, size(request%masters)
          call nodes_of_name(model, draft, request%at, request%masters(k)%s, one, log)
          if (size(one) > 1) call log%add_error(request%at, 'LINK', 'the set ' // &
            request%masters(k)%s // ' has ' // &
            whole_text(size(one)) // ' nodes', &
            'A value is linked to single nodes; the slave may be a set')
          good = good .and. size(one) == 1
          masters = [masters, one]
        end do
        if (.not. good) cycle
        do k = 1, size(slaves)
          n = slaves(k)
          link = linear_constraint(node=n, comp=request%comp, nodes=masters, comps=request%comps, &
            coefs=request%coefs, constant=request%constant, place=in_place(request%at))
          if (any(masters == n .and. request%comps == request%comp)) then
            call log%add_error(request%at, 'LINK', 'node ' // whole_text(n) // &
              ' is linked to itself', '')
          else if (model%fixed(request%comp, n)) then
            call log%add_error(request%at, 'LINK', 'direction ' // whole_text(request%comp) // &
              ' of node ' // &
              whole_text(n) // ' is fixed already', 'A value is either fixed or linked')
          else if (which(request%comp, n) > 0) then
            call log%add_error(request%at, 'LINK', 'direction ' // whole_text(request%comp) // &
              ' of node ' // &
              whole_text(n) // ' is linked already in ' // links(which(request%comp, n))%place, '')
          else
            links = [links, link]
            which(request%comp, n) = size(links)
          end if
        end do
      end associate
    end do
    if (log%error_count() == first_error) call resolve_chains(links, which, draft, log)
    call move_alloc(links, model%links)
  end subroutine resolve_links

  subroutine resolve_chains(links, which, draft, log)
    !! Replace masters that are linked by what they depend on.
    type(linear_constraint), intent(inout) :: links(:)
    integer, intent(in) :: which(:, :)          !! link of each dof (ndf,nn), 0: none
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    integer :: i, l, m, round

    do l = 1, size(links)
      do round = 1, size(links) + 1
        m = 0
        do i = 1, size(links(l)%nodes)
          m = which(links(l)%comps(i), links(l)%nodes(i))
          if (m > 0) exit
        end do
        if (m == 0) exit
        if (m == l .or. round > size(links)) then
          call log%add_error(draft%links(1)%at, 'LINK', 'the links of node ' // &
            whole_text(links(l)%node) // &
            ' run in a circle (' // links(l)%place // ')', '')
          return
        end if
        associate (link => links(l), other => links(m))
          link%constant = link%constant + link%coefs(i)*other%constant
          link%coefs = [link%coefs(:i - 1), link%coefs(i + 1:), link%coefs(i)*other%coefs]
          link%nodes = [link%nodes(:i - 1), link%nodes(i + 1:), other%nodes]
          link%comps = [link%comps(:i - 1), link%comps(i + 1:), other%comps]
        end associate
      end do
    end do
  end subroutine resolve_chains

  subroutine nodes_of_name(model, draft, at, name, nodes, log)
    !! The name is a node number or a set.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: name
    integer, allocatable, intent(out) :: nodes(:)   !! none after an error
    type(message_log), intent(inout) :: log
    type(value_request) :: request
    real(wp) :: x
    integer :: used

    request%at = at
    call read_number(name, x, used)
    if (used == len(name) .and. abs(x) < huge(1)) then
      request%first = nint(x)
      request%last = request%first
    else
      request%set = name
    end if
    call nodes_of_request(model, draft, request, 'LINK', nodes, log)
  end subroutine nodes_of_name
end module conditions
