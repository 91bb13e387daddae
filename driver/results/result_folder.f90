module result_folder
  !! The folder of a run's results. A marker file `.bezel` in it lists every file that the program wrote there; when the
  !! folder is used again these files, and no others, are removed. A folder that holds something and has no marker
  !! belongs to somebody else and is refused.
  use byte_file, only: byte_file_type
  use file_system, only: make_folder, folder_exists, file_exists, remove_file, read_text_file, system_error
  implicit none (type, external)
  private
  public :: result_folder_type

  character(*), parameter :: marker_name = '.bezel'
  character(*), parameter :: marker_line = 'Files in this folder that bezel wrote and may replace:'

  type :: result_folder_type
    character(:), allocatable :: path
    logical :: failed = .false.
    character(:), allocatable :: message    !! fact and remedy, allocated if failed
    character(:), allocatable, private :: listed    !! names, each between line feeds
    type(byte_file_type), private :: marker
  contains
    procedure :: begin
    procedure :: resume
    procedure :: file
    procedure, private :: complain
  end type result_folder_type

contains

  subroutine begin(self, path)
    !! Make the folder, or empty it of what an earlier run wrote.
    class(result_folder_type), intent(inout) :: self
    character(*), intent(in) :: path

    character(:), allocatable :: names
    integer :: from, next
    logical :: done

    call clear(self, path)
    if (.not. folder_exists(path)) then
      if (file_exists(path)) then
        call self%complain('cannot write results to '//path//': it is a file. Remove it, or name another folder '// &
          'with --out.')
        return
      end if
    else if (file_exists(path//'/'//marker_name)) then
      call read_marker(self, names)
      if (self%failed) return
      from = 1
      do
        next = index(names(from:), new_line('a'))
        if (next == 0) exit
        if (next > 1) call remove_listed(self, names(from:from+next-2))
        from = from + next
      end do
      if (self%failed) return
    else
      ! only an empty folder can be removed
      done = remove_file(path)
      if (.not. done) then
        call self%complain('the folder '//path//' was not written by bezel and is left as it is. Remove it, or name '// &
          'another folder with --out.')
        return
      end if
    end if
    if (.not. make_folder(path)) then
      call self%complain('cannot make the folder '//path//': '//system_error()//'. Name another folder with --out.')
      return
    end if
    call self%marker%create_draft(path//'/'//marker_name)
    call self%marker%put_line(marker_line)
    call self%marker%publish()
    if (.not. self%marker%failed) call self%marker%extend(path//'/'//marker_name)
    if (self%marker%failed) call self%complain(self%marker%message)
  end subroutine begin

  subroutine resume(self, path)
    !! Go on in a folder that this program wrote.
    class(result_folder_type), intent(inout) :: self
    character(*), intent(in) :: path

    character(:), allocatable :: names

    call clear(self, path)
    if (.not. file_exists(path//'/'//marker_name)) then
      call self%complain('there are no results of bezel in '//path//' to continue from. Run without --restart.')
      return
    end if
    call read_marker(self, names)
    if (self%failed) return
    self%listed = new_line('a')//names
    call self%marker%extend(path//'/'//marker_name)
    if (self%marker%failed) call self%complain(self%marker%message)
  end subroutine resume

  function file(self, name) result(path)
    !! The path of a file in the folder, which is put on the list first. Failures show when it is written.
    class(result_folder_type), intent(inout) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: path

    path = self%path//'/'//name
    if (index(self%listed, new_line('a')//name//new_line('a')) > 0) return
    self%listed = self%listed//name//new_line('a')
    call self%marker%put_line(name)
    call self%marker%flush()
    if (self%marker%failed) call self%complain(self%marker%message)
  end function file

  subroutine clear(self, path)
    class(result_folder_type), intent(inout) :: self
    character(*), intent(in) :: path

    call self%marker%close()
    self%path = path
    self%failed = .false.
    if (allocated(self%message)) deallocate (self%message)
    self%listed = new_line('a')
  end subroutine clear

  subroutine read_marker(self, names)
    class(result_folder_type), intent(inout) :: self
    character(:), allocatable, intent(out) :: names    !! one a line

    character(:), allocatable :: text
    logical :: failed

    call read_text_file(self%path//'/'//marker_name, text, failed)
    names = ''
    if (.not. failed) failed = index(text, marker_line//new_line('a')) /= 1
    if (failed) then
      call self%complain('the list of files '//self%path//'/'//marker_name//' cannot be read. Remove the folder, '// &
        'or name another with --out.')
      return
    end if
    names = text(len(marker_line)+2:)
    if (len(names) > 0) names = names(:index(names, new_line('a'), back=.true.))
  end subroutine read_marker

  subroutine remove_listed(self, name)
    class(result_folder_type), intent(inout) :: self
    character(*), intent(in) :: name

    character(4), parameter :: endings(2) = [character(4) :: '', '.tmp']
    character(:), allocatable :: path
    integer :: k

    path = ''
    if (index(name, '/') > 0 .or. name == '.' .or. name == '..') return
    do k = 1, size(endings)
      path = self%path//'/'//name//trim(endings(k))
      if (.not. file_exists(path)) cycle
      if (folder_exists(path)) cycle
      if (.not. remove_file(path)) then
        call self%complain('cannot remove '//path//': '//system_error())
        return
      end if
    end do
  end subroutine remove_listed

  subroutine complain(self, message)
    class(result_folder_type), intent(inout) :: self
    character(*), intent(in) :: message

    if (self%failed) return
    self%failed = .true.
    self%message = message
  end subroutine complain
end module result_folder
