module command_words
  !! The words that begin the lines of a deck: those that the reader acts on itself (module deck_reader lists them) with
  !! those that begin and end the solution part, and the way in which messages write any of them.
  use messages, only: lower_case
  implicit none (type, external)
  private
  public :: control_word, command_form

contains

  pure function control_word(text) result(word)
    !! if, elif, else, endi, loop, next, incl, para, tabl, inte, batc, end; '' for anything else.
    character(*), intent(in) :: text
    character(4) :: word
    character(:), allocatable :: first
    integer :: n, k

    word = ''
    if (len(text) < 2) return
    if (scan(text(1:1), 'ieElLnNpPtTbBI') == 0) return
    n = scan(text, ' ,=(') - 1
    if (n < 0) n = len(text)
    first = lower_case(text(1:n))
    k = verify(text(n+1:), ' ')
    if (k > 0) then
      k = k + n
      if (text(k:k) == '=' .and. text(k:min(k+1, len(text))) /= '==') return
    end if
    select case (first)
    case ('if', 'end')
      word = first
      return
    case ('else')
      word = 'else'
      if (k > 0) then
        if (lower_case(text(k:min(k+1, len(text)))) == 'if' .and. verify(text(k+2:min(k+2, &
          len(text))), ' (') == 0) &
          word = 'elif'
      end if
      return
    end select
    if (n < 4) return
    select case (first(1:4))
    case ('loop', 'next', 'incl', 'para', 'tabl', 'batc', 'endi')
      word = first(1:4)
    case ('else')
      word = 'else'
      if (first(5:) == 'if') word = 'elif'
    case ('inte')
      if (n == 4 .or. first(5:min(6, n)) == 'ra') word = 'inte'
    end select
  end function control_word

  pure function command_form(word) result(command)
    !! FEAP's way to write a command: CONTact.
    character(*), intent(in) :: word
    character(len(word)) :: command
    integer :: i

    command = lower_case(word)
    do i = 1, min(4, len(word))
      if (command(i:i) >= 'a' .and. &
        command(i:i) <= 'z') command(i:i) = achar(iachar(command(i:i)) - 32)
    end do
  end function command_form
end module command_words
