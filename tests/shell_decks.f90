module shell_decks
  !! Models of shells from decks, parts to be put together by tests.
  use messages, only: message_log
  use model_data, only: model_type
  use mesh_decks, only: model_of
  implicit none (type, external)
  private
  public :: shell_model, strip_lines

  character(*), parameter :: thin(5) = [character(60) :: '', 'MATErial 1', 'SHELl', 'ELAStic STVK 12 0', 'THICkness 1']

contains

  function strip_lines(name, x1, x2, z1, z2, degree, n) result(lines)
    !! A strip of width 1 from (x1,z1) to (x2,z2) in n elements.
    character(*), intent(in) :: name, x1, x2, z1, z2, degree
    character(*), intent(in) :: n
    character(60) :: lines(12)

    lines = [character(60) :: 'PATCh ' // name, 'DEGRee 1 1', 'KNOTs 1 0 0 1 1', 'KNOTs 2 0 0 1 1', 'POINts', &
      x1 // ' 0 ' // z1, x2 // ' 0 ' // z2, x1 // ' 1 ' // z1, x2 // ' 1 ' // z2, 'ELEVate TO ' // degree, &
      'SUBDivide 1 ' // n, '']
  end function strip_lines

  subroutine shell_model(lines, model, log)
    !! With a shell of E = 12, nu = 0, t = 1, so that D = 1.
    character(*), intent(in) :: lines(:)
    type(model_type), intent(out) :: model
    type(message_log), intent(out) :: log

    call model_of([character(60) :: thin, '', lines], model, log, ndm=3)
  end subroutine shell_model
end module shell_decks
