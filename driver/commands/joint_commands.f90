module joint_commands
  !! JOINt: lines along which shells meet without a common slope, and the check that there are no others.
  !!
  !!     JOINt a.right b.left [STIFfness=1000]   along the common sides of these surfaces, or
  !!     JOINt a b ...                           along all seams between the elements of these sets:
  !!                                             a rotational spring of so many times D/h holds the angle
  !!     JOINt a.right b.left HINGe              both sides turn freely
  !!
  !! D = E t^3/(12 (1 - nu^2)) of the stiffer side, h the length of the side.
  use kinds, only: wp
  use messages, only: message_log, deck_place, string, quoted, name_hint, whole_text
  use number_text, only: write_number
  use deck_record, only: record
  use model_data, only: model_type, set_surface, set_elements, shell_joint_type
  use model_sets, only: find_set, find_set_of_kind, set_names
  use mesh_draft, only: draft_type, joint_request
  use shell_seams, only: shell_seam, find_seams
  implicit none (type, external)
  private
  public :: read_joint, resolve_joints

contains

  subroutine read_joint(command, draft, log)
    type(record), intent(in) :: command
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(joint_request) :: new
    type(string) :: name
    integer :: i, at_option

    new%at = command%at
    allocate (new%names(0))
    call command%number_option('stiffness', new%stiffness, log)
    call command%check_options([character(9) :: 'stiffness'], log)
    if (.not. new%stiffness > 0) call command%add_error(log, 'the stiffness of a joint must be positive', '', &
      command%find('stiffness'))
    at_option = command%find('stiffness')
    do i = 2, command%count
      if (at_option > 0 .and. (i == at_option .or. i == at_option - 1)) cycle
      if (command%key(i) == 'hing' .and. .not. command%is_quoted(i)) then
        new%is_hinge = .true.
      else
        call command%text(i, name%s, log, 'surface or element set')
        new%names = [new%names, name]
      end if
    end do
    if (size(new%names) == 0) then
      call command%add_error(log, 'nothing is named', 'Write the surfaces or the element sets that meet')
      return
    end if
    draft%joints = [draft%joints, new]
  end subroutine read_joint

  subroutine resolve_joints(model, draft, log)
    !! Put the joints on the seams; seams without joint are errors.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(shell_seam), allocatable :: seams(:)
    logical, allocatable :: named(:, :), taken(:)
    integer :: i, k, n, found, error_count

    allocate (model%joints(0))
    call find_seams(model, seams)
    allocate (taken(size(seams)), source=.false.)
    do i = 1, size(draft%joints)
      associate (request => draft%joints(i))
        error_count = log%error_count()
        call mark_sides(model, request%names, request%at, named, log)
        found = 0
        do k = 1, size(seams)
          if (.not. (named(seams(k)%side(1), seams(k)%element(1)) .and. named(seams(k)%side(2), seams(k)%element(2)))) cycle
          found = found + 1
          if (seams(k)%flipped .or. taken(k)) cycle
          taken(k) = .true.
          if (request%is_hinge) cycle
          n = size(model%joints)
          model%joints = [model%joints, shell_joint_type(seams(k)%element, seams(k)%side, request%stiffness)]
        end do
        if (found == 0 .and. log%error_count() == error_count) call log%add_error(request%at, 'JOINt', &
          'no seam of shells lies between the named surfaces', &
          'The sides must be tied (TIE) and meet with an angle or without a common slope')
      end associate
    end do
    call report_seams(model, draft, seams, taken, log)
  end subroutine resolve_joints

  subroutine mark_sides(model, names, at, named, log)
    type(model_type), intent(in) :: model
    type(string), intent(in) :: names(:)
    type(deck_place), intent(in) :: at
    logical, allocatable, intent(out) :: named(:, :)     !! (4,ne)
    type(message_log), intent(inout) :: log
    integer :: i, k, set

    allocate (named(4, model%mesh%ne), source=.false.)
    do i = 1, size(names)
      set = find_set_of_kind(model, names(i)%s, set_surface)
      if (set > 0) then
        do k = 1, size(model%sets(set)%items)
          if (model%sets(set)%sides(k) > 4) cycle
          if (model%sets(set)%sides(k) > 0) then
            named(model%sets(set)%sides(k), model%sets(set)%items(k)) = .true.
          else
            named(:, model%sets(set)%items(k)) = .true.
          end if
        end do
        cycle
      end if
      set = find_set_of_kind(model, names(i)%s, set_elements)
      if (set > 0) then
        named(:, model%sets(set)%items) = .true.
      else
        call log%add_error(at, 'JOINt', 'there is no surface or element set ' // quoted(names(i)%s), &
          name_hint(names(i)%s, set_names(model, 0), 'sets'))
      end if
    end do
  end subroutine mark_sides

  subroutine report_seams(model, draft, seams, taken, log)
    !! One message for each kind of fault between two data sets.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(shell_seam), intent(in) :: seams(:)
    logical, intent(in) :: taken(:)
    type(message_log), intent(inout) :: log
    logical :: told(size(seams))
    integer :: k, l, more

    if (model%ndm < 3) return
    told = taken .and. .not. seams%flipped
    do k = 1, size(seams)
      if (told(k)) cycle
      more = 0
      do l = k + 1, size(seams)
        if (told(l) .or. (seams(l)%flipped .neqv. seams(k)%flipped)) cycle
        if (draft%element_name(seams(l)%element(1)) /= draft%element_name(seams(k)%element(1))) cycle
        if (draft%element_name(seams(l)%element(2)) /= draft%element_name(seams(k)%element(2))) cycle
        told(l) = .true.
        more = more + 1
      end do
      call report(seams(k), more)
    end do

  contains

    subroutine report(seam, more)
      type(shell_seam), intent(in) :: seam
      integer, intent(in) :: more              !! sides of the same kind
      character(:), allocatable :: where, fact, remedy, first, second

      first = draft%element_name(seam%element(1))
      second = draft%element_name(seam%element(2))
      where = 'along the side of elements ' // whole_text(seam%element(1)) // ' and ' // whole_text(seam%element(2)) // &
        ' at (' // write_number(seam%x(1)) // ', ' // write_number(seam%x(2)) // ', ' // write_number(seam%x(3)) // ')'
      if (more > 0) where = where // ' and ' // whole_text(more) // ' more sides'
      if (seam%flipped) then
        fact = 'the normals of the shell point to opposite sides ' // where
        if (first /= second) fact = 'its normals and those of ' // second // ' point to opposite sides ' // where
        remedy = 'Turn one direction of a patch round, or exchange its two directions'
      else if (first == second) then
        fact = 'the functions are only continuous, without common derivatives, ' // where // &
          ': the shell would be a hinge there'
        remedy = 'Shells need smooth bases: no LAGRange, no inner knot repeated as often as the degree; or a JOINt along it'
      else
        fact = 'it has no common slope with ' // second // ' ' // where // ': the shell would be a hinge there'
        remedy = 'MERGe them with C1, or put a JOINt on the line'
      end if
      call log%add_error(draft%element_place(seam%element(1)), first, fact, remedy)
    end subroutine report
  end subroutine report_seams
end module joint_commands
