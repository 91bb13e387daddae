module end_face_commands
  !! ENDFace: a surface that turns about an axis through its centroid, rigid or free to warp, by a prescribed angle or
  !! under a given moment; and the HISTory of such a face.
  !!
  !!     ENDFace name SURFace=surface ROTAtion=angle | MOMEnt=moment [PROP=n] [WARPing] [AXIS=x y z]
  !!
  !! Angles are in radians, counter-clockwise positive or, in space, about AXIS.
  use kinds, only: wp
  use messages, only: message_log, deck_place, whole_text, quoted, name_hint, known_names, string, lower_case, in_place
  use deck_record, only: record
  use model_data, only: model_type, end_face_type
  use model_sets, only: nodes_of_set
  use mesh_draft, only: draft_type, end_face_request
  use interface_commands, only: surface_of
  implicit none (type, external)
  private
  public :: read_end_face, resolve_end_faces, resolve_face_histories

  character(8), parameter :: option_words(6) = [character(8) :: 'SURFace', 'ROTAtion', 'MOMEnt', 'PROP', 'WARPing', 'AXIS']
  integer, parameter :: angle = 1, multiplier = 2    !! components of a face's column

contains

  subroutine read_end_face(command, ndm, draft, log)
    type(record), intent(in) :: command
    integer, intent(in) :: ndm                      !! space dimension
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(end_face_request) :: new
    integer :: i

    new%at = command%at
    call command%text(2, new%name, log, 'name of the end face')
    i = 3
    do while (i <= command%count)
      select case (command%key(i))
      case ('surf')
        call command%text(i + 1, new%surface, log, 'surface')
        i = i + 2
      case ('rota', 'mome')
        if (new%has_value) call command%add_error(log, 'a second ' // command%word(i), &
          'The face has either a rotation or a moment', i)
        new%has_value = .true.
        new%turns = command%key(i) == 'rota'
        call command%number(i + 1, new%value, log, command%word(i))
        i = i + 2
      case ('prop')
        call command%integer(i + 1, new%prop, log, 'time function')
        i = i + 2
      case ('warp')
        new%warps = .true.
        i = i + 1
      case ('axis')
        if (ndm == 2) call command%add_error(log, 'a face of the plane has no AXIS', &
          'It turns about the normal of the plane', i)
        new%has_axis = .true.
        call command%numbers(i + 1, new%axis, log, 'components of the axis')
        if (.not. norm2(new%axis) > 0 .and. command%count >= i + 3) call command%add_error(log, &
          'the axis has no direction', '', i)
        i = i + 4
      case default
        call command%add_error(log, 'unknown word ' // quoted(command%word(i)), known_names(option_words, 'words'), i)
        return
      end select
    end do
    if (.not. allocated(new%surface)) then
      new%surface = ''
      call command%add_error(log, 'the surface is missing', 'Write SURFace=surface')
    end if
    if (.not. new%has_value) call command%add_error(log, 'neither rotation nor moment', &
      'Write ROTAtion=angle (in radians) or MOMEnt=moment; MOMEnt=0 lets the face turn freely')
    if (ndm == 3 .and. .not. new%has_axis) call command%add_error(log, 'the axis is missing', &
      'Write AXIS=x y z, the direction about which the face turns')
    do i = 1, size(draft%end_faces)
      if (lower_case(draft%end_faces(i)%name) == lower_case(new%name)) call command%add_error(log, 'the name ' // &
        quoted(new%name) // ' is taken', 'End faces have different names', 2)
    end do
    draft%end_faces = [draft%end_faces, new]
  end subroutine read_end_face

  subroutine resolve_end_faces(model, draft, log)
    !! After conditions and links: faces, the columns of their globals, and the conditions of these.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    integer, allocatable :: nodes(:), face_of(:)
    integer :: k, a, first_error

    allocate (model%end_faces(size(draft%end_faces)))
    allocate (face_of(model%nn), source=0)
    model%globals = 0
    do k = 1, size(draft%end_faces)
      associate (request => draft%end_faces(k), face => model%end_faces(k))
        first_error = log%error_count()
        face%name = request%name
        face%place = in_place(request%at)
        face%warps = request%warps
        face%axis = [0, 0, 1]
        if (norm2(request%axis) > 0) face%axis = request%axis/norm2(request%axis)
        if (request%prop > 0 .and. .not. any(model%props(:)%number == request%prop)) call log%add_error(request%at, &
          'ENDFace', 'the time function of PROP is not defined', 'Define it by PROPortional')
        face%set = surface_of(model, draft, request%at, 'ENDFace', 'surface', request%surface, log)
        model%globals = model%globals + 1
        face%rotation = model%columns()
        if (.not. face%warps) then
          model%globals = model%globals + 1
          face%translation = model%columns()
        end if
        call widen(model)
        model%fixed(:, face%rotation) = .true.
        if (request%turns) then
          model%disp(angle, face%rotation) = request%value
        else
          model%fixed(angle, face%rotation) = .false.
          model%force(angle, face%rotation) = request%value
        end if
        model%disp_prop(angle, face%rotation) = request%prop
        model%force_prop(angle, face%rotation) = request%prop
        if (face%warps) model%fixed(multiplier, face%rotation) = .false.
        if (.not. face%warps) model%fixed(model%ndm + 1:, face%translation) = .true.
        if (face%set == 0 .or. log%error_count() > first_error) cycle

        if (.not. is_face(model, face%set)) then
          call log%add_error(request%at, 'ENDFace', 'the surface ' // quoted(request%surface) // &
            ' is not a face of a body', 'Edges of shells cannot turn as end faces: their slope is not tied to them')
          cycle
        end if
        nodes = nodes_of_set(model, face%set)
        do a = 1, size(nodes)
          if (face_of(nodes(a)) > 0) then
            call log%add_error(request%at, 'ENDFace', 'node ' // whole_text(nodes(a)) // ' belongs to the end face ' // &
              model%end_faces(face_of(nodes(a)))%name // ' too', 'A point turns with one face')
            exit
          end if
          face_of(nodes(a)) = k
        end do
        if (log%error_count() > first_error) cycle
        if (face%warps) then
          if (all(model%fixed(1:model%ndm, nodes))) call log%add_error(request%at, 'ENDFace', &
            'all points of the face are fixed', 'Free them: the face turns by their movement')
        else
          call check_rigid(model, request, face, nodes, log)
        end if
      end associate
    end do
  end subroutine resolve_end_faces

  logical function is_face(model, set)
    !! Whether all facets of a surface have one parametric direction less than space.
    type(model_type), intent(in) :: model
    integer, intent(in) :: set
    integer :: i, e, dp

    is_face = .true.
    do i = 1, size(model%sets(set)%items)
      e = model%sets(set)%items(i)
      dp = model%mesh%dp(e)
      if (model%sets(set)%sides(i) > 0) dp = dp - 1
      is_face = is_face .and. dp == model%ndm - 1
    end do
  end function is_face

  subroutine widen(model)
    !! Conditions for the columns of new globals: free, without values or forces.
    type(model_type), intent(inout) :: model
    logical, allocatable :: fixed(:, :)

    allocate (fixed(model%ndf, model%columns()), source=.false.)
    fixed(:, 1:size(model%fixed, 2)) = model%fixed
    call move_alloc(fixed, model%fixed)
    call widen_reals(model%disp)
    call widen_reals(model%force)
    call widen_integers(model%disp_prop)
    call widen_integers(model%force_prop)

  contains

    subroutine widen_reals(array)
      real(wp), allocatable, intent(inout) :: array(:, :)
      real(wp), allocatable :: larger(:, :)

      allocate (larger(model%ndf, model%columns()), source=0.0_wp)
      larger(:, 1:size(array, 2)) = array
      call move_alloc(larger, array)
    end subroutine widen_reals

    subroutine widen_integers(array)
      integer, allocatable, intent(inout) :: array(:, :)
      integer, allocatable :: larger(:, :)

      allocate (larger(model%ndf, model%columns()), source=0)
      larger(:, 1:size(array, 2)) = array
      call move_alloc(larger, array)
    end subroutine widen_integers
  end subroutine widen

  subroutine check_rigid(model, request, face, nodes, log)
    !! Points of a rigid face depend on its globals alone. A direction along the axis, in which they only translate, may
    !! be held: the translation is held then (a plane of symmetry, plane strain in space).
    type(model_type), intent(inout) :: model
    type(end_face_request), intent(in) :: request
    type(end_face_type), intent(in) :: face
    integer, intent(in) :: nodes(:)
    type(message_log), intent(inout) :: log
    integer :: i, l, a

    do i = 1, model%ndm
      if (.not. any(model%fixed(i, nodes))) cycle
      a = nodes(findloc(model%fixed(i, nodes), .true., dim=1))
      if (model%ndm == 3 .and. abs(abs(face%axis(i)) - 1) < epsilon(1.0_wp) .and. &
        .not. any(abs(pack(model%disp(i, nodes), model%fixed(i, nodes))) > 0)) then
        model%fixed(i, face%translation) = .true.
        model%fixed(i, nodes) = .false.
      else
        call log%add_error(request%at, 'ENDFace', 'direction ' // whole_text(i) // ' of node ' // whole_text(a) // &
          ' of the face is fixed', 'Points of a rigid face move with it: free them, or let the face be WARPing')
        return
      end if
    end do
    do l = 1, size(model%links)
      associate (link => model%links(l))
        if (any(nodes == link%node)) then
          call log%add_error(request%at, 'ENDFace', 'node ' // whole_text(link%node) // ' of the face is linked in ' // &
            link%place, 'Points of a rigid face move with it: remove the LINK, or let the face be WARPing')
          return
        end if
        do i = 1, size(link%nodes)
          if (.not. any(nodes == link%nodes(i))) cycle
          call log%add_error(request%at, 'ENDFace', 'a LINK depends on node ' // whole_text(link%nodes(i)) // &
            ' of the face (' // link%place // ')', 'Link to points that do not belong to a rigid face')
          return
        end do
      end associate
    end do
  end subroutine check_rigid

  subroutine resolve_face_histories(model, draft, log)
    !! After resolve_histories and resolve_end_faces: histories that name an end face.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(string), allocatable :: names(:)
    integer :: i, k

    allocate (names(size(model%end_faces)))
    do k = 1, size(names)
      names(k)%s = model%end_faces(k)%name
    end do
    do i = 1, size(draft%histories)
      if (.not. allocated(draft%histories(i)%end_face)) cycle
      do k = 1, size(names)
        if (lower_case(names(k)%s) == lower_case(draft%histories(i)%end_face)) model%histories(i)%end_face = k
      end do
      if (model%histories(i)%end_face == 0) call log%add_error(draft%histories(i)%at, 'HISTory', &
        'there is no end face ' // quoted(draft%histories(i)%end_face), &
        name_hint(draft%histories(i)%end_face, names, 'end faces'))
    end do
  end subroutine resolve_face_histories
end module end_face_commands
