module interface_commands
  !! CONTact: a pair of surfaces; what happens between them is law data of an interface element.
  !!
  !!     CONTact name SLAVe=surface MASTer=surface PENAlty=e [GP=n] [SIDE=-1] [REACh=r] [THICkness=AUTO|d]
  !!       COHEsive PMAX=p GIC=G GMAX=g | STIFfness=K        cohesion
  !!       REVErsible                                        unloading follows the envelope back
  !!       BONDed   surface | BOX x1 x2 y1 y2 [z1 z2]        part that is bonded from the start (default: everything)
  !!       UNBOnded surface | BOX x1 x2 y1 y2 [z1 z2]        part that is cracked from the start
  !!
  !! The lines are optional and end with a blank line or the next command.
  use kinds, only: wp
  use messages, only: message_log, deck_place, quoted, name_hint, in_place
  use number_text, only: write_number
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, interface_type, bond_region, surface_load_type, history_request, &
    set_elements, set_surface
  use model_sets, only: find_set, find_set_of_kind, set_names, as_surface
  use mesh_draft, only: draft_type, interface_request
  use user_element, only: element_type, property_record
  use element_library, only: new_element
  use material_commands, only: define_element
  use data_lines, only: next_line, as_property
  use bond_regions, only: read_region, resolve_regions
  use surface_orientation, only: find_turned_pair
  implicit none (type, external)
  private
  public :: surface_of, read_contact, resolve_interfaces, resolve_loads, resolve_histories

contains

  subroutine read_contact(deck, command, model, draft, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(interface_type), allocatable :: larger(:)
    type(property_record), allocatable :: properties(:)
    type(deck_place), allocatable :: places(:)
    class(element_type), allocatable :: element
    character(:), allocatable :: known
    real(wp) :: penalty
    integer :: i, n

    n = size(model%interfaces)
    allocate (larger(n + 1))
    do i = 1, n
      call move_interface(model%interfaces(i), larger(i))
    end do
    associate (new => larger(n + 1))
      call command%text(2, new%name, log, 'name of the interface')
      new%place = in_place(command%at)
      penalty = -1
      call command%number_option('penalty', penalty, log)
      call command%integer_option('gp', new%gp, log)
      new%side = 0
      call command%integer_option('side', new%side, log)
      call command%number_option('reach', new%reach, log)
      call command%check_options([character(7) :: 'slave', 'master', 'penalty', 'gp', 'side', &
        'reach', 'thick'], log)
      call read_offset(command, new%offset, log)
      if (.not. command%has('penalty')) then
        call command%add_error(log, 'the penalty is missing', &
          'Write PENAlty=e, a stiffness per area: pressure = e*depth')
      else if (.not. penalty > 0) then
        call command%add_error(log, 'the penalty must be positive', '', command%find('penalty'))
      end if
      if (new%gp < 1) call command%add_error(log, 'at least one Gauss point is needed', &
        'Write GP=2', command%find('gp'))
      if (command%has('side') .and. abs(new%side) /= 1) call command%add_error(log, 'the side of a master is 1 or -1', '', &
        command%find('side'))
      if (new%reach < 0) call command%add_error(log, 'the reach of the search is a length', '', &
        command%find('reach'))
      ! component by component: gfortran 12 allocates `words` too short in a structure constructor
      allocate (properties(1))
      properties(1)%place = new%place
      allocate (properties(1)%words(1))
      properties(1)%words(1) = 'pena'
      properties(1)%values = [penalty]
    end associate
    call move_alloc(larger, model%interfaces)

    places = [command%at]
    call read_law(deck, model%ndm, properties, places, model%interfaces(n + 1)%regions, log)
    call new_element('gpts', element, known)
    if (penalty > 0) call define_element(element, model%ndm, 'CONTact', command%at, properties, &
      places, log)
    call move_alloc(element, model%interfaces(n + 1)%element)
    call note_surfaces(command, draft, log)
  end subroutine read_contact

  subroutine read_offset(command, offset, log)
    !! THICkness: the gap is that of the faces of shells, not that of their mid-surfaces.
    type(record), intent(in) :: command
    real(wp), intent(out) :: offset              !! [length]; negative: to be taken from the materials
    type(message_log), intent(inout) :: log
    integer :: i

    offset = 0
    i = command%find('thickness')
    if (i > 0) then
      if (command%key(i) == 'auto') then
        offset = -1
        return
      end if
    end if
    call command%number_option('thickness', offset, log)
    if (offset < 0) then
      call command%add_error(log, 'the distance of mid-surfaces whose shells touch cannot be negative', &
        'Write THICkness=AUTO to take it from the materials', command%find('thickness'))
      offset = 0
    end if
  end subroutine read_offset

  subroutine read_law(deck, ndm, properties, places, regions, log)
    !! The lines after a CONTact record: law data for the element, parts for the interface.
    type(deck_type), intent(inout) :: deck
    integer, intent(in) :: ndm
    type(property_record), allocatable, intent(inout) :: properties(:)   !! appended to
    type(deck_place), allocatable, intent(inout) :: places(:)            !! of each
    type(bond_region), allocatable, intent(out) :: regions(:)
    type(message_log), intent(inout) :: log
    type(property_record) :: property
    type(bond_region) :: region
    type(record) :: rec
    logical :: more, cohesive
    integer :: i

    allocate (regions(0))
    cohesive = .false.
    do
      call next_line(deck, rec, log, more, .true.)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      select case (rec%key(1))
      case ('bond', 'unbo')
        call read_region(rec, ndm, region, log)
        regions = [regions, region]
      case default
        cohesive = cohesive .or. rec%key(1) == 'cohe'
        call as_property(rec, 1, property, log)
        properties = [properties, property]
        places = [places, rec%at]
      end select
    end do
    if (cohesive) return
    do i = 1, size(regions)
      call log%add_error(regions(i)%at, 'CONTact', 'an interface without cohesion has no bonded part', &
        'Add COHEsive PMAX=p GIC=G GMAX=g, or leave the line out')
    end do
  end subroutine read_law

  subroutine note_surfaces(command, draft, log)
    type(record), intent(in) :: command
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(interface_request) :: new

    new%at = command%at
    new%slave = ''
    new%master = ''
    call command%text_option('slave', new%slave, log)
    call command%text_option('master', new%master, log)
    if (.not. command%has('slave')) call command%add_error(log, 'the slave surface is missing', &
      'Write SLAVe=surface')
    if (.not. command%has('master')) call command%add_error(log, 'the master surface is missing', &
      'Write MASTer=surface')
    draft%interfaces = [draft%interfaces, new]
  end subroutine note_surfaces

  subroutine move_interface(from, to)
    type(interface_type), intent(inout) :: from
    type(interface_type), intent(inout) :: to

    call move_alloc(from%name, to%name)
    call move_alloc(from%place, to%place)
    to%slave = from%slave
    to%master = from%master
    to%gp = from%gp
    to%side = from%side
    to%offset = from%offset
    to%reach = from%reach
    call move_alloc(from%regions, to%regions)
    call move_alloc(from%element, to%element)
  end subroutine move_interface

  subroutine resolve_interfaces(model, draft, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    integer :: i

    do i = 1, size(draft%interfaces)
      associate (request => draft%interfaces(i))
        model%interfaces(i)%slave = surface_of(model, draft, request%at, 'CONTact', &
          'slave surface', request%slave, log)
        model%interfaces(i)%master = surface_of(model, draft, request%at, 'CONTact', &
          'master surface', request%master, log)
        if (model%interfaces(i)%slave == model%interfaces(i)%master &
          .and. model%interfaces(i)%slave > 0) call &
          log%add_error(request%at, 'CONTact', 'slave and master are the same surface', &
          'Contact of a surface with itself needs two parts of it')
      end associate
      call check_surface(model, draft%interfaces(i)%at, 'slave', model%interfaces(i)%slave, log)
      call check_surface(model, draft%interfaces(i)%at, 'master', model%interfaces(i)%master, log)
      call check_orientation(model, draft, draft%interfaces(i)%at, 'CONTact', 'master', model%interfaces(i)%master, log)
      call resolve_regions(model, i, log)
      if (model%interfaces(i)%offset < 0) call take_offset(model, draft%interfaces(i)%at, model%interfaces(i), log)
    end do
  end subroutine resolve_interfaces

  subroutine check_surface(model, at, role, set, log)
    !! Not the edge of a shell.
    type(model_type), intent(in) :: model
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: role             !! slave, master
    integer, intent(in) :: set                   !! index into sets; 0: an error of its own
    type(message_log), intent(inout) :: log

    if (set == 0) return
    associate (items => model%sets(set)%items, sides => model%sets(set)%sides)
      if (any(sides > 0 .and. model%mesh%dp(items) < model%ndm)) call log%add_error(at, 'CONTact', 'the ' // role // &
        ' surface ' // quoted(model%sets(set)%name) // ' has edges of shells', &
        'Contact is between surfaces: write the name of the patch')
    end associate
  end subroutine check_surface

  subroutine check_orientation(model, draft, at, command, role, set, log)
    !! A master of shells has one normal, whose sign holds for all of it; so has a surface under pressure.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: command, role    !! of the surface: master, loaded
    integer, intent(in) :: set                   !! index into sets; 0: an error of its own
    type(message_log), intent(inout) :: log
    integer, allocatable :: shells(:), part(:)
    integer :: pair(2), i
    real(wp) :: x(3)

    if (set == 0 .or. model%ndm < 3) return
    associate (items => model%sets(set)%items)
      shells = pack(items, model%sets(set)%sides == 0 .and. model%mesh%dp(items) == 2)
    end associate
    allocate (part(size(shells)), source=0)
    do i = 1, size(draft%origins)
      where (shells >= draft%origins(i)%first .and. shells <= draft%origins(i)%last) part = i
    end do
    call find_turned_pair(model, shells, part, pair, x)
    if (pair(1) > 0) call log%add_error(at, command, 'the normals of the ' // role // ' surface ' // &
      quoted(model%sets(set)%name) // ' point to opposite sides where ' // draft%element_name(pair(1)) // ' and ' // &
      draft%element_name(pair(2)) // ' meet, at (' // write_number(x(1)) // ', ' // write_number(x(2)) // ', ' // &
      write_number(x(3)) // ')', 'Turn one direction of a patch round, or exchange its two directions')
  end subroutine check_orientation

  subroutine take_offset(model, at, it, log)
    !! Half the thicknesses of both shells.
    type(model_type), intent(in) :: model
    type(deck_place), intent(in) :: at
    type(interface_type), intent(inout) :: it
    type(message_log), intent(inout) :: log
    real(wp) :: least, most
    integer :: sets(2), k, e

    sets = [it%slave, it%master]
    it%offset = 0
    if (any(sets == 0)) return
    do k = 1, 2
      associate (set => model%sets(sets(k)))
        least = huge(least)
        most = 0
        do e = 1, size(set%items)
          if (model%material_of(set%items(e)) == 0) return       ! an error of its own
          associate (material => model%materials(model%material_of(set%items(e))))
            if (.not. allocated(material%element)) return
            least = min(least, material%element%shell_thickness())
            most = max(most, material%element%shell_thickness())
          end associate
        end do
        if (size(set%items) > 0 .and. least < most) then
          call log%add_error(at, 'CONTact', 'the elements of ' // quoted(set%name) // ' are not of one thickness', &
            'Write THICkness=d, the distance of the mid-surfaces where the shells touch')
          return
        end if
        it%offset = it%offset + most/2
      end associate
    end do
    if (.not. it%offset > 0) call log%add_error(at, 'CONTact', 'neither surface is a shell, so there is no thickness', &
      'Leave out THICkness')
  end subroutine take_offset

  integer function surface_of(model, draft, at, command, what, name, log) result(index)
    !! The surface of this name, 0 after an error.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: command, what, name
    type(message_log), intent(inout) :: log

    index = 0
    if (len(name) == 0) return
    index = find_set_of_kind(model, name, set_surface)
    if (index == 0) index = find_set(model, name)
    if (index == 0) then
      call log%add_error(at, command, 'there is no ' // what // ' ' // quoted(name), &
        name_hint(name, set_names(model, set_surface), 'surfaces'))
      return
    end if
    call as_surface(model, index)
    if (index == 0) then
      call log%add_error(at, command, what // ' ' // quoted(name) // ' is not a surface', &
        name_hint(name, set_names(model, set_surface), 'surfaces'))
    else if (size(model%sets(index)%items) == 0 .and. .not. draft%has_lost_sets) then
      call log%add_error(at, command, what // ' ' // quoted(name) // ' has no elements', &
        name_hint('', set_names(model, set_surface), 'surfaces'))
      index = 0
    end if
  end function surface_of

  subroutine resolve_loads(model, draft, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(surface_load_type) :: load
    integer :: i

    do i = 1, size(draft%loads)
      associate (request => draft%loads(i))
        load = request%load
        load%place = in_place(request%at)
        if (load%kind == 'body') then
          load%set = find_set_of_kind(model, request%set, set_elements)
          if (load%set == 0) call log%add_error(request%at, 'SLOAd', 'there is no element set ' // &
            quoted(request%set), name_hint(request%set, set_names(model, set_elements), &
            'element sets'))
        else
          load%set = surface_of(model, draft, request%at, 'SLOAd', 'surface', request%set, log)
        end if
        if (load%set > 0) call check_load(model, load, request%at, request%set, log)
        if (any(load%kind == ['pressure', 'follower'])) call check_orientation(model, draft, request%at, 'SLOAd', &
          'loaded', load%set, log)
        if (load%prop > 0 &
          .and. .not. any(model%props(:)%number == load%prop)) call log%add_error(request%at, &
          'SLOAd', 'the time function of PROP is not defined', 'Define it by PROPortional')
        model%loads = [model%loads, load]
      end associate
    end do
  end subroutine resolve_loads

  subroutine check_load(model, load, at, name, log)
    !! What shells cannot take, and what solids cannot.
    type(model_type), intent(in) :: model
    type(surface_load_type), intent(in) :: load
    type(deck_place), intent(in) :: at
    character(*), intent(in) :: name               !! of its set
    type(message_log), intent(inout) :: log
    logical :: is_edge

    associate (set => model%sets(load%set))
      if (size(set%items) == 0) return
      if (load%kind == 'body') then
        if (any(model%mesh%dp(set%items) < model%ndm)) call log%add_error(at, 'SLOAd', quoted(name) // &
          ' has shells, which take no force per volume', 'Write TRACtion: force per area of the shell')
        return
      end if
      is_edge = model%ndm == 3 .and. all(model%mesh%dp(set%items) == 2 .and. set%sides > 0)
      if (load%kind == 'moment' .and. .not. is_edge) then
        call log%add_error(at, 'SLOAd', quoted(name) // ' is not the edge of a shell', &
          'A moment acts on a side of a surface patch')
      else if (is_edge .and. .not. any(load%kind == ['moment  ', 'traction'])) then
        call log%add_error(at, 'SLOAd', quoted(name) // ' is the edge of a shell, which takes no pressure', &
          'Write TRACtion (force per length) or MOMEnt (moment per length)')
      end if
    end associate
  end subroutine check_load

  subroutine resolve_histories(model, draft, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(history_request) :: new
    integer :: i

    do i = 1, size(draft%histories)
      associate (request => draft%histories(i))
        new = request%request
        new%place = in_place(request%at)
        if (len(request%set) > 0) then
          new%set = find_set(model, request%set)
          if (new%set == 0) call log%add_error(request%at, 'HISTory', 'there is no set ' // &
            quoted(request%set), &
            name_hint(request%set, set_names(model, 0), 'sets'))
        end if
        model%histories = [model%histories, new]
      end associate
    end do
  end subroutine resolve_histories
end module interface_commands
