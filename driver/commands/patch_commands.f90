module patch_commands
  !! PATCh: a NURBS patch from degrees, knots and control points, refined line by line, or the
  !! Lagrange mesh mapped on it. Its elements are the element set NAME, its sides the surfaces
  !! NAME.left (s=0), .right (s=1), .bottom (t=0), .top (t=1), .back (u=0), .front (u=1).
  use kinds, only: wp
  use messages, only: message_log, quoted, in_place
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, set_elements, set_surface
  use model_sets, only: add_set, find_set
  use mesh_draft, only: draft_type, patch_part
  use data_lines, only: next_line
  use element_commands, only: element_options, begin_origin
  use nurbs_patch, only: patch_extraction, side_of_grid
  use lagrange_mesh, only: break_list, patch_breaks, lagrange_mesh_nodes, lagrange_mesh_elements
  use patch_lines, only: patch_draft, carry_out_line
  use t_spline, only: t_spline_type, create_t_spline
  use t_bodies, only: t_body, add_t_body
  use t_patch_lines, only: report_suitability
  use status_codes, only: ok, status_text
  implicit none (type, external)
  private
  public :: read_patch

  character(6), parameter :: side_names(6) = [character(6) :: 'left', 'right', 'bottom', 'top', &
    'back', 'front']

contains

  subroutine read_patch(deck, command, model, draft, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(patch_draft) :: new
    type(record) :: rec
    character(:), allocatable :: name
    integer :: body, material, error_count, old
    logical :: more
    character(:), allocatable :: taken_at

    error_count = log%error_count()
    material = 1
    body = 1
    call command%text(2, name, log, 'name of the patch')
    call element_options(command, material, body, log)
    old = find_set(model, name)
    if (old > 0) taken_at = model%sets(old)%place
    if (draft%find_part(name) > 0) taken_at = in_place(draft%parts(draft%find_part(name))%at)
    if (allocated(taken_at)) call command%add_error(log, 'the name ' // quoted(name) // ' is taken', 'See ' // taken_at)
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      call carry_out_line(deck, rec, model%ndm, new, log)
      ! what follows a wrong line would only be blamed for it
      if (log%error_count() == error_count) cycle
      call deck%skip_set(rec, log)
      exit
    end do
    if (log%error_count() == error_count .and. .not. new%is_built) call command%add_error(log, &
      'the patch has no control points', 'Give DEGRee, KNOTs for each direction, then POINts')
    if (log%error_count() == error_count .and. new%is_t) call report_suitability(command, new%mesh, log)
    if (log%error_count() > error_count) then
      ! its sets are known all the same, so that there is no second message for each use of them
      if (.not. allocated(taken_at)) call add_sets(model, name, in_place(command%at), 3, 1, [0, 0, 0])
      draft%has_lost_sets = .true.
      return
    end if
    if (new%is_part) then
      call draft%add_part(patch_part(at=command%at, name=name, patch=new%patch, material=material, body=body))
      return
    end if
    call begin_origin(draft, command, 'PATCh', name)
    if (new%is_t) then
      call add_t_spline(new, name, material, body, command, model, draft, log)
      return
    end if
    call add_to_mesh(new, name, material, body, command, model, draft)
  end subroutine read_patch

  subroutine add_to_mesh(new, name, material, body, command, model, draft)
    type(patch_draft), intent(in) :: new
    character(*), intent(in) :: name
    integer, intent(in) :: material, body
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(break_list) :: spans(3)
    real(wp), allocatable :: x(:, :)
    integer :: a, first, first_node

    first = model%mesh%ne + 1
    first_node = draft%nn + 1
    if (new%is_lagrange) then
      spans = patch_breaks(new%patch)
      call lagrange_mesh_nodes(new%patch, new%degree, spans, new%nodes, x)
      do a = 1, size(x, 2)
        call draft%set_node(first_node + a - 1, x(1:model%ndm, a), 1.0_wp)
      end do
      call lagrange_mesh_elements(new%patch%dp, new%degree, spans, new%nodes, &
        [(a, a = first_node, draft%nn)], model%mesh)
    else
      do a = 1, size(new%patch%cp, 2)
        call draft%set_node(first_node + a - 1, new%patch%cp(1:model%ndm, a), new%patch%cp(4, a))
      end do
      call patch_extraction(new%patch, [(a, a = first_node, draft%nn)], model%mesh)
    end if
    call draft%note_elements(first, model%mesh%ne, material, body, command%at)
    call add_sets(model, name, in_place(command%at), new%patch%dp, first, new%patch%elements())
  end subroutine add_to_mesh

  subroutine add_t_spline(new, name, material, body, command, model, draft, log)
    !! A locally refined surface, or the solid swept by it.
    type(patch_draft), intent(in) :: new
    character(*), intent(in) :: name
    integer, intent(in) :: material, body
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(t_spline_type) :: spline
    type(t_body) :: made
    integer :: side, status

    call create_t_spline(new%mesh, new%patch, spline, status)
    if (status == ok) call add_t_body(new%mesh, spline, new%sweep, model, draft, made, status)
    if (status /= ok) then
      call command%add_error(log, status_text(status), '')
      return
    end if
    call draft%note_elements(made%first, made%last, material, body, command%at)
    call add_set(model, name, in_place(command%at), set_elements, made%all_elements(), [integer ::])
    do side = 1, merge(6, 4, allocated(new%sweep))
      call made%add_surface(name // '.' // trim(side_names(side)), in_place(command%at), side, made%elements_on(side), model)
    end do
  end subroutine add_t_spline

  subroutine add_sets(model, name, place, dp, first, n)
    !! The elements of a patch and its sides.
    type(model_type), intent(inout) :: model
    character(*), intent(in) :: name, place
    integer, intent(in) :: dp              !! directions
    integer, intent(in) :: first           !! its first element
    integer, intent(in) :: n(3)            !! elements per direction
    integer :: e, side

    call add_set(model, name, place, set_elements, [(e, e = first, first + product(n) - 1)], &
      [integer ::])
    do side = 1, 2*dp
      if (product(n) > 0) then
        call add_side(side_of_grid(n, side) + (first - 1))
      else
        call add_side([integer ::])
      end if
    end do

  contains

    subroutine add_side(items)
      integer, intent(in) :: items(:)     !! its elements

      call add_set(model, name // '.' // trim(side_names(side)), place, set_surface, items, &
        spread(side, 1, size(items)))
    end subroutine add_side
  end subroutine add_sets
end module patch_commands
