module mesh_completion
  !! What happens at END: counts are compared, ties, sets and conditions are carried out, the model
  !! is checked.
  use messages, only: message_log, whole_text
  use model_data, only: model_type
  use mesh_draft, only: draft_type
  use merge_commands, only: check_parts
  use set_commands, only: resolve_ties, resolve_sets
  use spline_commands, only: follow_tied_nodes
  use mesh_exports, only: check_exports
  use conditions, only: resolve_conditions, resolve_links
  use joint_commands, only: resolve_joints
  use shell_conditions, only: resolve_clamps, resolve_slopes
  use end_face_commands, only: resolve_end_faces, resolve_face_histories
  use interface_commands, only: resolve_interfaces, resolve_loads, resolve_histories
  use point_histories, only: resolve_point_histories
  use model_check, only: check_dimensions, check_mesh, check_nodes, check_geometry, switch_off_unused
  implicit none (type, external)
  private
  public :: complete_model

contains

  subroutine complete_model(model, draft, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    integer :: error_count, mesh_errors
    logical :: all_materials

    error_count = log%error_count()
    call check_parts(model, draft, log)
    model%nn = draft%nn
    model%x = draft%x(:, 1:draft%nn)
    model%w = draft%w(1:draft%nn)
    call model%mesh%finish()
    model%body_of = draft%body(1:model%mesh%ne)
    if (draft%has_lost_file) return    ! most of what is to be checked would be blamed for it
    if (error_count == 0) call compare_counts(model, draft, log)
    call find_materials(model, draft, all_materials, log)

    ! an element that was lost would be blamed on all that use it
    mesh_errors = log%error_count()
    if (draft%lost_elements == 0 .and. .not. draft%has_lost_sets) call check_mesh(model, draft, log)
    if (log%error_count() > mesh_errors) return
    if (any(model%mesh%nodes < 1) .or. any(model%mesh%nodes > model%nn)) return
    call check_nodes(model, draft, log)
    if (log%error_count() == mesh_errors .and. all_materials) call check_dimensions(model, draft, log)
    if (log%error_count() == mesh_errors) call check_geometry(model, draft, log)

    if (draft%lost_elements > 0) draft%has_lost_sets = .true.
    call resolve_ties(model, draft, log)
    call follow_tied_nodes(model, draft)
    call resolve_sets(model, draft, log)
    call resolve_clamps(model, draft, log)
    call resolve_conditions(model, draft, log)
    call resolve_links(model, draft, log)
    call resolve_end_faces(model, draft, log)
    mesh_errors = log%error_count()
    if (all_materials .and. .not. draft%has_lost_sets) call resolve_joints(model, draft, log)
    if (log%error_count() == mesh_errors) call resolve_slopes(model, draft, log)
    call resolve_loads(model, draft, log)
    call resolve_interfaces(model, draft, log)
    call resolve_histories(model, draft, log)
    call resolve_face_histories(model, draft, log)
    mesh_errors = log%error_count()
    if (all_materials .and. .not. draft%has_lost_sets .and. mesh_errors == error_count) &
      call resolve_point_histories(model, draft, log)
    if (all_materials .and. log%error_count() == 0) call switch_off_unused(model, draft, log)
    if (log%error_count() == error_count) call check_exports(model, log)
    call model%mesh%finish()
  end subroutine complete_model

  subroutine compare_counts(model, draft, log)
    !! The counts of the header, where they are not 0.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log

    call compare('numnp', 'nodes', draft%numnp, model%nn)
    call compare('numel', 'elements', draft%numel, model%mesh%ne)
    call compare('nummat', 'materials', draft%nummat, size(model%materials))

  contains

    subroutine compare(name, what, announced, found)
      character(*), intent(in) :: name, what
      integer, intent(in) :: announced, found

      if (announced == 0 .or. announced == found) return
      call log%add_error(draft%header, 'FEAP', 'the deck announces ' // whole_text(announced) // &
        ' ' // what // &
        ' and has ' // whole_text(found), 'Correct ' // name // ', or write 0: it is counted then')
    end subroutine compare
  end subroutine compare_counts

  subroutine find_materials(model, draft, all_found, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    logical, intent(out) :: all_found            !! every element has a formulation
    type(message_log), intent(inout) :: log
    integer :: e, i, last, last_index, told
    character(:), allocatable :: known

    known = 'There are no materials'
    do i = 1, size(model%materials)
      if (i == 1) known = 'Known materials:'
      known = known // ' ' // whole_text(model%materials(i)%number)
    end do
    allocate (model%material_of(model%mesh%ne))
    last = 0
    last_index = 0
    told = 0
    all_found = .true.
    do e = 1, model%mesh%ne
      if (e == 1 .or. draft%material(e) /= last) then
        last = draft%material(e)
        last_index = findloc(model%materials(:)%number, last, dim=1)
      end if
      model%material_of(e) = last_index
      if (last_index == 0) then
        all_found = .false.
        if (told == last) cycle
        told = last
        call log%add_error(draft%element_place(e), draft%element_name(e), 'element ' // &
          whole_text(e) // &
          ' has material ' // whole_text(last) // ', which is not defined', known)
      else if (.not. allocated(model%materials(last_index)%element)) then
        all_found = .false.
      end if
    end do
  end subroutine find_materials
end module mesh_completion
