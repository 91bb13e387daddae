module output_commands
  !! HISTory, OUTPut and RESTart: what is written and when.
  use kinds, only: wp
  use messages, only: lower_case, message_log, quoted, known_names
  use deck_record, only: record
  use model_data, only: model_type
  use mesh_draft, only: draft_type, history_draft
  implicit none (type, external)
  private
  public :: read_history, read_output, read_restart

  character(12), parameter :: history_words(14) = [character(12) :: 'REACtion', 'DISPlacement', &
    'WORK', 'ELAStic', 'PENAlty', 'DISSipated', 'PENEtration', 'BALAnce', 'SET', 'ENDFace', &
    'MOMEnt', 'ROTAtion', 'SURFace', 'POINt']

contains

  subroutine read_history(command, ndm, draft, log)
    !! HISTory label SET=name [REACtion] [DISPlacement], or
    !! HISTory label SURFace=name POINt=x y [z] DISPlacement of a material point, or
    !! HISTory label ENDFace=name [MOMEnt] [ROTAtion] (both if neither is named), or
    !! HISTory [WORK] [ELAStic] [PENAlty] [DISSipated] [PENEtration] [BALAnce] of the whole model.
    type(record), intent(in) :: command
    integer, intent(in) :: ndm                      !! space dimension
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(history_draft) :: new
    integer :: first, i, set_item, face_item, surface_item, point_item

    new%at = command%at
    new%set = ''
    new%request%label = ''
    set_item = 0
    face_item = 0
    surface_item = 0
    point_item = 0
    first = 2
    if (command%has('set')) then
      call command%text(2, new%request%label, log, 'label')
      call command%text_option('set', new%set, log)
      call command%check_options(['set'], log)
      set_item = command%find('set')
      first = 3
    else if (command%has('endface')) then
      call command%text(2, new%request%label, log, 'label')
      new%end_face = ''
      call command%text_option('endface', new%end_face, log)
      call command%check_options(['endface'], log)
      face_item = command%find('endface')
      first = 3
    else if (command%has('surface') .or. command%has('point')) then
      call command%text(2, new%request%label, log, 'label')
      new%surface = ''
      call command%text_option('surface', new%surface, log)
      call command%check_options(['surface', 'point  '], log)
      if (len(new%surface) == 0) call command%add_error(log, 'the surface of the point is missing', &
        'Write HISTory label SURFace=name POINt=x y z DISPlacement')
      surface_item = command%find('surface')
      point_item = command%find('point')
      if (point_item > 0) then
        call command%numbers(point_item, new%point(1:ndm), log, 'coordinates of the point')
      else
        call command%add_error(log, 'the point is missing', 'Write HISTory label SURFace=name POINt=x y z DISPlacement')
      end if
      first = 3
    end if
    associate (r => new%request)
      do i = first, command%count
        if (i == set_item .or. i + 1 == set_item .or. i == face_item .or. i + 1 == face_item) cycle
        if (i == surface_item .or. i + 1 == surface_item) cycle
        if (point_item > 0 .and. i + 1 >= point_item .and. i < point_item + ndm) cycle
        select case (command%key(i))
        case ('reac'); r%reaction = .true.
        case ('disp'); r%displacement = .true.
        case ('mome'); r%moment = .true.
        case ('rota'); r%rotation = .true.
        case ('work'); r%work = .true.
        case ('elas'); r%elastic = .true.
        case ('pena'); r%penalty = .true.
        case ('diss'); r%dissipated = .true.
        case ('pene'); r%penetration = .true.
        case ('bala'); r%balance = .true.
        case default
          call command%add_error(log, 'unknown quantity ' // quoted(command%word(i)), &
            known_names(history_words, 'words'), i)
          return
        end select
      end do
      if (allocated(new%surface)) then
        if (r%reaction) call command%add_error(log, 'a point has no reaction', 'Reactions are those of a SET')
        r%displacement = .true.
      else if ((r%reaction .or. r%displacement) .and. set_item == 0) then
        call command%add_error(log, 'reactions and displacements are those of a set', &
          'Write HISTory label SET=name REACtion DISPlacement')
      end if
      if (set_item > 0 .and. .not. (r%reaction .or. r%displacement)) call command%add_error(log, &
        'nothing is asked of the set', 'Add REACtion or DISPlacement')
      if ((r%moment .or. r%rotation) .and. face_item == 0) call command%add_error(log, &
        'moments and rotations are those of an end face', &
        'Write HISTory label ENDFace=name MOMEnt ROTAtion')
      if (face_item > 0 .and. .not. (r%moment .or. r%rotation)) then
        r%moment = .true.
        r%rotation = .true.
      end if
      if (command%count < 2) call command%add_error(log, 'nothing is asked for', &
        known_names(history_words, 'words'))
      if (is_taken(r%label)) call command%add_error(log, 'the label ' // quoted(r%label) // &
        ' is taken', &
        'Labels name the columns of history.csv')
    end associate
    draft%histories = [draft%histories, new]

  contains

    logical function is_taken(label)
      character(*), intent(in) :: label
      integer :: k

      is_taken = .false.
      if (len(label) == 0) return
      do k = 1, size(draft%histories)
        is_taken = is_taken .or. draft%histories(k)%request%label == label
      end do
    end function is_taken
  end subroutine read_history

  subroutine read_output(command, model, log)
    !! OUTPut NONE | [EVERy=n] [STEPs n1 n2 ...] [TIMEs t1 t2 ...].
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(message_log), intent(inout) :: log
    character(4) :: part
    character(:), allocatable :: word
    integer :: i, step
    real(wp) :: time

    if (command%count < 2) call command%add_error(log, 'nothing is asked for', &
      'Write OUTPut NONE, or any of EVERy=n, STEPs n1 n2 ..., TIMEs t1 t2 ...')
    part = ''
    do i = 2, command%count
      word = lower_case(command%word(i))
      select case (word)  ! whole words: a parameter may be called steps_press
      case ('none')
        model%outputs%fields = .false.
        part = ''
      case ('ever', 'every', 'step', 'steps', 'time', 'times')
        part = word
      case default
        select case (part)
        case ('ever')
          call command%integer(i, model%outputs%every, log, 'number of steps')
          if (model%outputs%every < 1) call command%add_error(log, &
            'EVERy needs a positive number of steps', '', i)
        case ('step')
          call command%integer(i, step, log, 'step')
          model%outputs%steps = [model%outputs%steps, step]
        case ('time')
          call command%number(i, time, log, 'time')
          model%outputs%times = [model%outputs%times, time]
        case default
          call command%add_error(log, 'unknown word ' // quoted(command%word(i)), &
            'Write OUTPut NONE, or any of EVERy=n, STEPs n1 n2 ..., TIMEs t1 t2 ...', i)
          return
        end select
      end select
    end do
  end subroutine read_output

  subroutine read_restart(command, model, log)
    !! RESTart EVERy=n (0: never).
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(message_log), intent(inout) :: log

    if (.not. command%has('every')) call command%add_error(log, 'the number of steps is missing', &
      'Write RESTart EVERy=20')
    call command%integer_option('every', model%outputs%restart_every, log)
    call command%check_options(['every'], log)
    if (model%outputs%restart_every < 0) call command%add_error(log, 'a negative number of steps', &
      '')
  end subroutine read_restart
end module output_commands
