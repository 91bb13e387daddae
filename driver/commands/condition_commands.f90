module condition_commands
  !! BOUNdary, DISPlacement, FORCe, FPROportional, PROPortional, LINK and SLOAd.
  !!
  !! Differences from FEAP: a record may name a set instead of a node; codes and values of several
  !! records add up to one condition (see module conditions); generated nodes take the codes of the
  !! record before, whatever their sign; time functions are mesh commands, lists of time and value.
  use kinds, only: wp
  use messages, only: message_log, string, quoted, whole_text, known_names
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, time_function
  use mesh_draft, only: draft_type, value_request, link_request, load_request, append_value
  use data_lines, only: next_line, node_or_set
  implicit none (type, external)
  private
  public :: read_values, read_proportional, read_links, read_surface_load

contains

  subroutine read_values(deck, command, model, draft, log)
    !! BOUNdary, DISPlacement, FORCe, FPROportional: records `n ng v1 v2 ..` or `set v1 v2 ..`. From
    !! node n to that of the next record, nodes n+ng, n+2ng, ... get values on a line between both
    !! (DISP, FORC), or those of the first.
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(in) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(record) :: rec
    type(value_request) :: new, generated
    character(:), allocatable :: set
    integer :: i, ng, n_old, ng_old, node
    real(wp) :: v(model%ndf), v_old(model%ndf)
    logical :: is_node, more, whole
    type(string), allocatable :: names(:)

    whole = command%key(1) == 'boun' .or. command%key(1) == 'fpro'
    allocate (names, source=draft%set_names_so_far(model))
    n_old = 0
    ng_old = 0
    v_old = 0
    do
      call next_line(deck, rec, log, more, names=names)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      call node_or_set(rec, 1, is_node, node, set, log)
      if (.not. is_node .and. len(set) == 0) cycle
      ng = 0
      if (is_node) call rec%integer(2, ng, log, 'increment', 0)
      i = merge(3, 2, is_node)
      call rec%check_count(i, i - 1 + model%ndf, log, trim(merge('node, increment, values', &
        'set, values            ', &
        is_node)))
      if (rec%count < i) cycle
      v = 0
      call read_components(rec, i, v, whole, log)
      new = value_request(at=rec%at, v1=v, v2=v, step=1)
      if (is_node) then
        new%first = node
        new%last = node
        if (n_old > 0 .and. ng_old /= 0) then
          if (mod(node - n_old, ng_old) /= 0 .or. (node - n_old)/ng_old < 1) then
            call rec%add_error(log, 'node ' // whole_text(node) // ' cannot be reached from ' // &
              whole_text(n_old) // &
              ' in steps of ' // whole_text(ng_old), 'Correct the increment of the record before')
          else if ((node - n_old)/ng_old > 1) then
            generated = new
            generated%first = n_old
            generated%last = merge(node - ng_old, node, whole)
            generated%step = ng_old
            generated%v1 = v_old
            generated%keeps = whole
            call keep(generated)
          end if
        end if
      else
        new%set = set
      end if
      call keep(new)
      n_old = merge(node, 0, is_node)
      ng_old = ng
      v_old = v
    end do

  contains

    subroutine keep(request)
      type(value_request), intent(in) :: request

      select case (command%key(1))
      case ('boun'); call append_value(draft%boundary, draft%n_boundary, request)
      case ('disp'); call append_value(draft%displacement, draft%n_displacement, request)
      case ('forc'); call append_value(draft%force, draft%n_force, request)
      case default;  call append_value(draft%proportional, draft%n_proportional, request)
      end select
    end subroutine keep
  end subroutine read_values

  subroutine read_components(rec, first, v, whole, log)
    type(record), intent(in) :: rec
    integer, intent(in) :: first              !! item
    real(wp), intent(inout) :: v(:)           !! those that are given
    logical, intent(in) :: whole
    type(message_log), intent(inout) :: log
    integer :: i, k

    do i = 1, min(size(v), rec%count - first + 1)
      if (whole) then
        call rec%integer(first - 1 + i, k, log, 'component', 0)
        v(i) = k
      else
        call rec%number(first - 1 + i, v(i), log, 'component', 0.0_wp)
      end if
    end do
  end subroutine read_components

  subroutine read_proportional(deck, command, model, log)
    !! PROPortional n, then pairs of time and value, several to a line.
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(message_log), intent(inout) :: log
    type(time_function) :: new
    type(record) :: rec
    real(wp), allocatable :: pairs(:)
    integer :: i
    logical :: more

    call command%integer(2, new%number, log, 'number of the time function', 1)
    if (new%number < 1) call command%add_error(log, 'time functions are numbered from 1', '', 2)
    do i = 1, size(model%props)
      if (model%props(i)%number == new%number) call command%add_error(log, 'time function ' // &
        whole_text(new%number) // ' is defined twice', 'Give the second another number')
    end do
    allocate (new%t(0), new%v(0))
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      if (mod(rec%count, 2) /= 0) then
        call rec%add_error(log, 'a time without value', 'Lines hold pairs: t1 v1 t2 v2 ...')
        cycle
      end if
      allocate (pairs(rec%count))
      call rec%numbers(1, pairs, log, 'times and values')
      new%t = [new%t, pairs(1::2)]
      new%v = [new%v, pairs(2::2)]
      deallocate (pairs)
      do i = max(2, size(new%t) - rec%count/2 + 1), size(new%t)
        if (new%t(i) > new%t(i - 1)) cycle
        call rec%add_error(log, 'times of a time function must increase', '')
        exit
      end do
    end do
    if (size(new%t) == 0) then
      call command%add_error(log, 'the time function is empty', &
        'Give lines of time and value, then a blank line')
      new%t = [0.0_wp]
      new%v = [0.0_wp]
    end if
    model%props = [model%props, new]
  end subroutine read_proportional

  subroutine read_links(deck, model, draft, log)
    !! Records `slave comp constant  node1 comp1 coef1  node2 comp2 coef2 ...`.
    type(deck_type), intent(inout) :: deck
    type(model_type), intent(in) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(link_request) :: new
    type(record) :: rec
    integer :: error_count, i
    logical :: more

    do
      call next_line(deck, rec, log, more, names=draft%set_names_so_far(model))
      if (.not. more) exit
      if (rec%is_damaged) cycle
      error_count = log%error_count()
      if (rec%count < 3 .or. mod(rec%count, 3) /= 0) then
        call rec%add_error(log, 'expected groups of three items, found ' // &
          whole_text(rec%count) // ' items', &
          'Write slave comp constant node1 comp1 coef1 ...')
        cycle
      end if
      new = link_request(at=rec%at)
      allocate (new%masters(rec%count/3 - 1), new%comps(rec%count/3 - 1), &
        new%coefs(rec%count/3 - 1))
      call read_dof(1, new%slave, new%comp)
      call rec%number(3, new%constant, log, 'constant', 0.0_wp)
      do i = 1, size(new%masters)
        call read_dof(3*i + 1, new%masters(i)%s, new%comps(i))
        call rec%number(3*i + 3, new%coefs(i), log, 'coefficient')
      end do
      if (log%error_count() == error_count) draft%links = [draft%links, new]
    end do

  contains

    subroutine read_dof(i, name, comp)
      integer, intent(in) :: i
      character(:), allocatable, intent(out) :: name
      integer, intent(out) :: comp
      integer :: node
      logical :: is_node

      call node_or_set(rec, i, is_node, node, name, log)
      if (is_node) name = whole_text(node)
      call rec%integer(i + 1, comp, log, 'direction')
      if (comp < 1 .or. comp > model%ndf) call rec%add_error(log, 'there is no direction ' // &
        whole_text(comp), &
        'Directions are 1 to ' // whole_text(model%ndf), i + 1)
    end subroutine read_dof
  end subroutine read_links

  subroutine read_surface_load(command, model, draft, log)
    !! SLOAd set PRESsure p | FOLLower p | TRACtion t1 t2 [t3] | BODY b1 b2 [b3] | MOMEnt m  [PROP=n] [GP=n].
    type(record), intent(in) :: command
    type(model_type), intent(in) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(load_request) :: new

    new%at = command%at
    call command%text(2, new%set, log, 'surface or element set')
    select case (command%key(3))
    case ('pres'); new%load%kind = 'pressure'
    case ('foll'); new%load%kind = 'follower'
    case ('trac'); new%load%kind = 'traction'
    case ('body'); new%load%kind = 'body'
    case ('mome'); new%load%kind = 'moment'
    case default
      call command%add_error(log, 'unknown load ' // quoted(command%word(3)), &
        known_names([character(8) :: &
        'PRESsure', 'FOLLower', 'TRACtion', 'BODY', 'MOMEnt'], 'loads'), 3)
      return
    end select
    if (any(new%load%kind == ['traction', 'body    '])) then
      call command%numbers(4, new%load%value(1:model%ndm), log, 'components of the load')
    else
      call command%number(4, new%load%value(1), log, trim(merge('moment  ', 'pressure', new%load%kind == 'moment')))
    end if
    call command%integer_option('prop', new%load%prop, log)
    call command%integer_option('gp', new%load%gp, log)
    if (new%load%gp < 0) call command%add_error(log, 'a negative number of Gauss points', '')
    call command%check_options([character(8) :: 'prop', 'gp', 'pressure', 'follower', 'traction', &
      'body', 'moment'], log)
    draft%loads = [draft%loads, new]
  end subroutine read_surface_load
end module condition_commands
