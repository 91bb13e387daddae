module end_face_decks
  !! Small bodies with an end face, for tests: a block in the plane or in space, and a thin beam.
  use deck_runs, only: deck_run
  use deck_files, only: write_lines, remove_file
  implicit none (type, external)
  private
  public :: open_block, open_beam

  character(*), parameter :: path = 'test_end_face_deck.inp'
  character(*), parameter :: block_2d(14) = [character(72) :: 'FEAP * * block', '0 0 0 2 2', 'PATCh block', &
    'DEGRee 1 1', 'KNOTs 1 0 0 1 1', 'KNOTs 2 0 0 1 1', 'POINts', '0 0', '2 0', '0.1 1', '2.2 1.1', 'ELEVate TO 2 2', &
    'SUBDivide 1 2', '']
  character(*), parameter :: block_3d(19) = [character(72) :: 'FEAP * * block', '0 0 0 3 3', 'PATCh block', &
    'DEGRee 1 1 1', 'KNOTs 1 0 0 1 1', 'KNOTs 2 0 0 1 1', 'KNOTs 3 0 0 1 1', 'POINts', '0 0 0', '2 0 0', '0.1 1 0', &
    '2.2 1.1 0', '0 0 0.8', '2 0.1 0.9', '0 1 0.7', '2.1 1 0.8', 'ELEVate TO 2 2 1', 'SUBDivide 1 2', '']
  character(*), parameter :: material(5) = [character(72) :: 'MATErial 1', 'SOLId', 'ELAStic STVK 10 0.3', 'FINIte', '']

contains

  subroutine open_block(run, ndm, lines)
    !! A block of about 2 x 1 (x 0.8), degree 2, St. Venant-Kirchhoff; conditions as given.
    type(deck_run), intent(inout), target :: run
    integer, intent(in) :: ndm
    character(*), intent(in) :: lines(:)

    if (ndm == 2) then
      call open_deck(run, [character(72) :: block_2d, material, lines, 'END'])
    else
      call open_deck(run, [character(72) :: block_3d, material, lines, 'END'])
    end if
  end subroutine open_block

  subroutine open_beam(run, height, lines)
    !! A beam of length 10 along x, cubic NURBS, 20 elements, E = 1000, nu = 0.3; a time function 1 of slope 1.
    type(deck_run), intent(inout), target :: run
    character(*), intent(in) :: height
    character(*), intent(in) :: lines(:)

    call open_deck(run, [character(72) :: 'FEAP * * beam', 'PARAmeter', 'h = '//height, '', '0 0 0 2 2', 'PATCh beam', &
      'DEGRee 1 1', 'KNOTs 1 0 0 1 1', 'KNOTs 2 0 0 1 1', 'POINts', '0 -h/2', '10 -h/2', '0 h/2', '10 h/2', &
      'ELEVate TO 3 3', 'SUBDivide 1 20', '', 'MATErial 1', 'SOLId', 'ELAStic STVK 1000 0.3', 'FINIte', '', &
      'PROPortional 1', '0 0 10 10', '', lines, 'END'])
  end subroutine open_beam

  subroutine open_deck(run, lines)
    type(deck_run), intent(inout), target :: run
    character(*), intent(in) :: lines(:)
    character(1) :: none(0)

    call write_lines(path, lines)
    call run%open_file(path, none)
    call remove_file(path)
  end subroutine open_deck
end module end_face_decks
