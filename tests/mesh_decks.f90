module mesh_decks
  !! Models from the text of a deck, for tests of the mesh commands.
  use messages, only: message_log
  use deck_reader, only: deck, setting
  use model_data, only: model_type
  use mesh_commands, only: read_model
  use model_sets, only: find_set
  use deck_files, only: write_lines, remove_file
  implicit none (type, external)
  private
  public :: model_of, set_index, square, plain_material

  !> a unit square as one bilinear element, parts to be put into decks
  character(*), parameter :: square(9) = [character(24) :: 'PATCh block', 'DEGRee 1 1', &
    'KNOTs 1 0 0 1 1', &
    'KNOTs 2 0 0 1 1', 'POINts', '0 0', '1 0', '0 1', '1 1']
  character(*), parameter :: plain_material(5) = [character(24) :: '', 'MATErial 1', 'SOLId', &
    'ELAStic ISOTropic 1 0.3', '']

contains

  subroutine model_of(lines, model, log, ndm)
    !! FEAP's line, the counts and END are added.
    character(*), intent(in) :: lines(:)
    type(model_type), intent(out) :: model
    type(message_log), intent(out) :: log
    integer, intent(in), optional :: ndm     !! space dimension, 2 if not given
    character(*), parameter :: path = 'test_mesh_deck.inp'
    character(max(16, len(lines))) :: all_lines(size(lines) + 3)
    type(setting) :: none(0)
    type(deck) :: input

    all_lines(1) = 'FEAP * * test'
    all_lines(2) = '0 0 0 2 2'
    if (present(ndm)) write (all_lines(2), '(a,2(1x,i0))') '0 0 0', ndm, ndm
    all_lines(3:size(lines) + 2) = lines
    all_lines(size(lines) + 3) = 'END'
    call write_lines(path, all_lines)
    call input%open(path, none, log)
    call read_model(input, model, log)
    call input%finish(log)
    call input%close()
    call remove_file(path)
  end subroutine model_of

  integer function set_index(model, name)
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name

    set_index = find_set(model, name)
    if (set_index == 0) error stop 'test deck without the set that its test asks for'
  end function set_index
end module mesh_decks
