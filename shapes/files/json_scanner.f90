module json_scanner
  !! Values of a JSON text one after another, without a tree: the caller knows what it expects
  !! and passes over the rest.
  !!
  !!     call json%begin('{', more)
  !!     do while (json%more_items('}'))
  !!       call json%read_key(key)
  !!       select case (key)
  !!       case ('nodes'); ...
  !!       case default;   call json%skip_value()
  !!       end select
  !!     end do
  !!
  !! The first error stays, with its line; from then on there are no more items.
  use kinds, only: wp, i8
  use number_text, only: read_number
  use extraction_mesh, only: printable
  implicit none (type, external)
  private
  public :: json_type

  character, parameter :: line_feed = achar(10)

  type :: json_type
    character(:), allocatable :: text
    integer(i8) :: pos = 1               !! next character
    integer :: line = 1
    logical :: failed = .false.
    character(:), allocatable :: fact    !! what is wrong, at `line`
    logical, private :: is_first = .false.   !! no item of the array or object was read yet
  contains
    procedure :: open => open_text
    procedure :: begin
    procedure :: more_items
    procedure :: read_key
    procedure :: read_string
    procedure :: read_number => read_json_number
    procedure :: read_whole
    procedure :: skip_value
    procedure :: refuse_rest
    procedure, private :: fail
    procedure, private :: skip_blanks
    procedure, private :: peek
  end type json_type

contains

  subroutine open_text(self, text)
    class(json_type), intent(inout) :: self
    character(*), intent(in) :: text

    self%text = text
    self%pos = 1
    self%line = 1
    self%failed = .false.
    self%is_first = .false.
  end subroutine open_text

  pure subroutine fail(self, fact)
    class(json_type), intent(inout) :: self
    character(*), intent(in) :: fact

    if (self%failed) return
    self%failed = .true.
    self%fact = fact
  end subroutine fail

  pure subroutine skip_blanks(self)
    class(json_type), intent(inout) :: self

    do while (self%pos <= len(self%text, i8))
      select case (self%text(self%pos:self%pos))
      case (line_feed)
        self%line = self%line + 1
      case (' ', achar(9), achar(13))
        continue
      case default
        return
      end select
      self%pos = self%pos + 1
    end do
  end subroutine skip_blanks

  pure subroutine peek(self, c)
    class(json_type), intent(inout) :: self
    character, intent(out) :: c          !! the next character that counts; null at the end

    call self%skip_blanks()
    c = achar(0)
    if (self%pos <= len(self%text, i8)) c = self%text(self%pos:self%pos)
    if (c == achar(0) .and. self%pos > len(self%text, i8)) call self%fail('the file ends too early')
  end subroutine peek

  subroutine begin(self, opening, what)
    !! Enters an array or an object.
    class(json_type), intent(inout) :: self
    character, intent(in) :: opening     !! [ or {
    character(*), intent(in) :: what     !! for messages

    character :: c

    if (self%failed) return
    call self%peek(c)
    if (self%failed) return
    if (c /= opening) then
      call self%fail('expected ' // opening // ' of ' // what // ', found "' // printable(c) // '"')
      return
    end if
    self%pos = self%pos + 1
    self%is_first = .true.
  end subroutine begin

  logical function more_items(self, closing)
    !! Is there another item? Else the array or object is left.
    class(json_type), intent(inout) :: self
    character, intent(in) :: closing     !! ] or }

    character :: c

    more_items = .false.
    if (self%failed) return
    call self%peek(c)
    if (self%failed) return
    if (c == closing) then
      self%pos = self%pos + 1
      self%is_first = .false.
      return
    end if
    if (.not. self%is_first) then
      if (c /= ',') then
        call self%fail('expected , or ' // closing // ', found "' // printable(c) // '"')
        return
      end if
      self%pos = self%pos + 1
      call self%peek(c)
      if (self%failed) return
    end if
    self%is_first = .false.
    more_items = .true.
  end function more_items

  subroutine read_key(self, key)
    class(json_type), intent(inout) :: self
    character(:), allocatable, intent(out) :: key

    character :: c

    call self%read_string(key)
    if (self%failed) return
    call self%peek(c)
    if (c /= ':') call self%fail('expected : after "' // printable(key) // '"')
    self%pos = self%pos + 1
  end subroutine read_key

  subroutine read_string(self, string)
    !! Escapes stay as they are written.
    class(json_type), intent(inout) :: self
    character(:), allocatable, intent(out) :: string

    character :: c
    integer(i8) :: first

    string = ''
    if (self%failed) return
    call self%peek(c)
    if (self%failed) return
    if (c /= '"') then
      call self%fail('expected a text in quotes, found "' // printable(c) // '"')
      return
    end if
    first = self%pos + 1
    call skip_string(self)
    if (.not. self%failed) string = self%text(first:self%pos-2)
  end subroutine read_string

  pure subroutine skip_string(self)
    !! From the opening quote to behind the closing one.
    class(json_type), intent(inout) :: self

    do
      self%pos = self%pos + 1
      if (self%pos > len(self%text, i8)) exit
      select case (self%text(self%pos:self%pos))
      case ('"')
        self%pos = self%pos + 1
        return
      case ('\')
        self%pos = self%pos + 1
      case (line_feed)
        exit
      end select
    end do
    call self%fail('a text in quotes does not end')
  end subroutine skip_string

  subroutine read_json_number(self, x)
    class(json_type), intent(inout) :: self
    real(wp), intent(out) :: x

    character :: c
    integer(i8) :: last
    integer :: used

    x = 0
    if (self%failed) return
    call self%peek(c)
    if (self%failed) return
    last = self%pos - 1
    do while (last < len(self%text, i8))
      select case (self%text(last+1:last+1))
      case (',', ']', '}', ' ', line_feed, achar(9), achar(13))
        exit
      end select
      last = last + 1
    end do
    if (last < self%pos) then
      call self%fail('expected a number, found "' // c // '"')
      return
    end if
    call read_number(self%text(self%pos:last), x, used)
    if (used /= last - self%pos + 1) then
      call self%fail('"' // printable(self%text(self%pos:last)) // '" is not a finite number')
      return
    end if
    self%pos = last + 1
  end subroutine read_json_number

  subroutine read_whole(self, i)
    class(json_type), intent(inout) :: self
    integer, intent(out) :: i

    real(wp) :: x

    i = 0
    call self%read_number(x)
    if (self%failed) return
    if (abs(x) < real(huge(i), wp)) then
      i = nint(x)
      if (.not. abs(x - i) > 0) return
    end if
    call self%fail('expected a whole number')
  end subroutine read_whole

  subroutine skip_value(self)
    !! Whatever it is.
    class(json_type), intent(inout) :: self

    character :: c
    integer :: depth

    if (self%failed) return
    depth = 0
    do
      call self%peek(c)
      if (self%failed) return
      select case (c)
      case ('{', '[')
        depth = depth + 1
        self%pos = self%pos + 1
      case ('}', ']')
        if (depth == 0) then
          call self%fail('expected a value, found "' // c // '"')
          return
        end if
        depth = depth - 1
        self%pos = self%pos + 1
      case ('"')
        call skip_string(self)
        if (self%failed) return
      case (',', ':')
        if (depth == 0) then
          call self%fail('expected a value, found "' // c // '"')
          return
        end if
        self%pos = self%pos + 1
        cycle
      case default
        do while (self%pos <= len(self%text, i8))
          select case (self%text(self%pos:self%pos))
          case (',', ':', ']', '}', '[', '{', '"', ' ', line_feed, achar(9), achar(13))
            exit
          end select
          self%pos = self%pos + 1
        end do
      end select
      if (depth == 0) return
    end do
  end subroutine skip_value

  subroutine refuse_rest(self)
    !! Nothing may follow.
    class(json_type), intent(inout) :: self

    if (self%failed) return
    call self%skip_blanks()
    if (self%pos <= len(self%text, i8)) &
      call self%fail('the file goes on after its last bracket')
  end subroutine refuse_rest
end module json_scanner
