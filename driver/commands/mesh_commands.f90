module mesh_commands
  !! The mesh part of a deck: from the line after FEAP to END. What follows is left in the deck for
  !! others.
  use messages, only: message_log, quoted, name_hint, string, closest_name
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type
  use mesh_draft, only: draft_type
  use data_lines, only: next_line, mesh_commands_known
  use node_commands, only: read_header, read_coordinates
  use element_commands, only: read_elements, read_operator, read_bezier
  use patch_commands, only: read_patch
  use merge_commands, only: read_merge
  use spline_commands, only: read_spline_file, read_export
  use quad_mesh_commands, only: read_quad_mesh
  use set_commands, only: read_set, read_tie
  use material_commands, only: read_material
  use condition_commands, only: read_values, read_proportional, read_links, read_surface_load
  use joint_commands, only: read_joint
  use shell_conditions, only: read_shell_condition
  use interface_commands, only: read_contact
  use end_face_commands, only: read_end_face
  use output_commands, only: read_history, read_output, read_restart
  use mesh_completion, only: complete_model
  use model_summary, only: describe_model
  implicit none (type, external)
  private
  public :: read_model, describe_model

contains

  subroutine read_model(deck, model, log)
    !! All errors that can be found are in the log; the model is complete only if there are none.
    type(deck_type), intent(inout) :: deck
    type(model_type), intent(inout) :: model    !! nothing in it yet
    type(message_log), intent(inout) :: log
    type(draft_type) :: draft
    type(record) :: rec
    logical :: good

    call read_header(deck, model, draft, log, good)
    if (.not. good) then
      call skip_mesh(deck, log)
      return
    end if
    call draft%start(model)
    do
      call deck%next_command(rec, log)
      if (rec%end_of_deck) then
        call rec%add_error(log, 'the mesh part of the deck has no END', 'END stands before BATCh')
        exit
      end if
      if (rec%is_damaged) cycle
      if (rec%key(1) == 'end') exit
      if (rec%key(1) == 'batc' .or. rec%key(1) == 'stop') then
        call rec%add_error(log, 'the mesh part of the deck has no END', 'END stands before BATCh')
        call deck%push_back(rec)
        exit
      end if
      call read_command(deck, rec, model, draft, log)
    end do
    call complete_model(model, draft, log)
  end subroutine read_model

  subroutine skip_mesh(deck, log)
    !! Goes on behind END, or before BATCh.
    type(deck_type), intent(inout) :: deck
    type(message_log), intent(inout) :: log
    type(record) :: rec

    do
      call deck%next_record(rec, log)
      if (rec%end_of_deck .or. rec%key(1) == 'end') return
      if (rec%key(1) == 'batc') exit
    end do
    call deck%push_back(rec)
  end subroutine skip_mesh

  subroutine read_command(deck, rec, model, draft, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log

    select case (rec%key(1))
    case ('coor'); call read_coordinates(deck, model, draft, log)
    case ('elem'); call read_elements(deck, rec, model, draft, log)
    case ('oper'); call read_operator(deck, rec, model, draft, log)
    case ('bezi'); call read_bezier(deck, rec, model, draft, log)
    case ('patc'); call read_patch(deck, rec, model, draft, log)
    case ('merg'); call read_merge(deck, rec, model, draft, log)
    case ('t-sp'); call read_spline_file(deck, rec, model, draft, log)
    case ('quad'); call read_quad_mesh(deck, rec, model, draft, log)
    case ('tie');  call read_tie(rec, draft, log)
    case ('set');  call read_set(rec, draft, log)
    case ('mate'); call read_material(deck, rec, model, log)
    case ('boun', 'disp', 'forc', 'fpro'); call read_values(deck, rec, model, draft, log)
    case ('prop'); call read_proportional(deck, rec, model, log)
    case ('link'); call read_links(deck, model, draft, log)
    case ('sloa'); call read_surface_load(rec, model, draft, log)
    case ('join'); call read_joint(rec, draft, log)
    case ('clam', 'symm'); call read_shell_condition(rec, draft, log)
    case ('cont'); call read_contact(deck, rec, model, draft, log)
    case ('endf'); call read_end_face(rec, model%ndm, draft, log)
    case ('hist'); call read_history(rec, model%ndm, draft, log)
    case ('outp'); call read_output(rec, model, log)
    case ('rest'); call read_restart(rec, model, log)
    case ('expo'); call read_export(rec, model, log)
    case default;  call refuse(deck, rec, log)
    end select
  end subroutine read_command

  subroutine refuse(deck, rec, log)
    !! An unknown command; what follows it is passed over to the next blank line or known command.
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    type(message_log), intent(inout) :: log
    type(string) :: keys(size(mesh_commands_known))
    character(:), allocatable :: hint
    integer :: i
    logical :: more

    do i = 1, size(keys)
      keys(i)%s = mesh_commands_known(i)(1:4)
    end do
    i = closest_name(trim(rec%key(1)), keys)
    if (i > 0) then
      hint = 'Did you mean ' // quoted(trim(mesh_commands_known(i))) // '?'
    else
      hint = name_hint(rec%word(1), mesh_commands_known, 'commands')
    end if
    rec%command = ''
    call rec%add_error(log, 'there is no mesh command ' // quoted(rec%word(1)), hint)
    do
      call next_line(deck, rec, log, more, may_end=.true.)
      if (.not. more) exit
    end do
  end subroutine refuse
end module mesh_commands
